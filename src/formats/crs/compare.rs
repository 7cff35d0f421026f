//! Whether two systems mean the same, and in what they differ.

use crate::crs::epsg;
use crate::crs::names::{is_same_datum, letters};
use crate::crs::system::{Ellipsoid, Geographic, Horizontal, Kind, Projection, System, Vertical};

/// Degrees: a tenth of a millimetre on the ground.
const ANGLE_TOLERANCE: f64 = 1e-9;
/// Metres.
const LENGTH_TOLERANCE: f64 = 1e-4;
/// Parts of scale factors.
const RATIO_TOLERANCE: f64 = 1e-9;
/// Metres of semi-major axes.
const AXIS_TOLERANCE: f64 = 1e-3;
/// Of inverse flattenings; older files state them with seven digits after the point.
const FLATTENING_TOLERANCE: f64 = 1e-6;

/// In what two systems differ, as "unit: metre and foot" and the like; empty if they mean the same. What only
/// one of them states is no difference.
pub fn differences(a: &System, b: &System) -> Vec<String> {
    let mut found = Differences::default();
    if let (Some(a), Some(b)) = (&a.horizontal, &b.horizontal) {
        found.horizontal(a, b);
    }
    if let (Some(a), Some(b)) = (&a.vertical, &b.vertical) {
        found.vertical(a, b);
    }
    found.0
}

/// In what a definition differs from that of its own code in the EPSG dataset. Names are not compared.
pub(crate) fn contradictions(stated: &Horizontal) -> Vec<String> {
    let mut found = Differences::default();
    let known = stated.code.and_then(epsg::system).and_then(|system| system.horizontal);
    if let Some(known) = known {
        found.numbers(stated, &known);
    }
    found.0
}

#[derive(Default)]
struct Differences(Vec<String>);

impl Differences {
    fn add(&mut self, what: &str, a: impl std::fmt::Display, b: impl std::fmt::Display) {
        self.0.push(format!("{what}: {a} and {b}"));
    }

    fn check(&mut self, what: &str, a: f64, b: f64, tolerance: f64) {
        if (a - b).abs() > tolerance {
            self.add(what, a, b);
        }
    }

    fn horizontal(&mut self, a: &Horizontal, b: &Horizontal) {
        if a.code.is_some() && a.code == b.code && a.unit.is_same(&b.unit) {
            return;
        }
        match (&a.kind, &b.kind) {
            (Kind::Unresolved, _) | (_, Kind::Unresolved) => {
                if a.code != b.code || a.code.is_none() && letters(&a.name) != letters(&b.name) {
                    self.add("system", a.short_name(), b.short_name());
                } else if !a.unit.is_same(&b.unit) {
                    self.add("unit", &a.unit, &b.unit);
                }
            }
            _ => {
                if let (Some(of_a), Some(of_b)) = (a.base(), b.base()) {
                    self.datum(of_a, of_b);
                }
                self.numbers(a, b);
            }
        }
    }

    fn datum(&mut self, a: &Geographic, b: &Geographic) {
        let is_same = match (epsg::datum_code(a), epsg::datum_code(b)) {
            (Some(a), Some(b)) => a == b,
            _ => is_same_datum(&a.datum, &b.datum),
        };
        if !is_same {
            self.add("datum", &a.datum, &b.datum);
        }
    }

    /// What is not a matter of names.
    fn numbers(&mut self, a: &Horizontal, b: &Horizontal) {
        if let (Some(of_a), Some(of_b)) = (a.base(), b.base()) {
            self.ellipsoid(of_a, of_b);
        }
        match (&a.kind, &b.kind) {
            (Kind::Projected(_, of_a), Kind::Projected(_, of_b)) => self.projection(of_a, of_b),
            (of_a, of_b) if of_a.name() != of_b.name() => self.add("kind", of_a.name(), of_b.name()),
            _ => {}
        }
        if !a.unit.is_same(&b.unit) {
            self.add("unit", &a.unit, &b.unit);
        }
    }

    fn ellipsoid(&mut self, a: &Geographic, b: &Geographic) {
        let (of_a, of_b) = (&a.ellipsoid, &b.ellipsoid);
        if !of_a.is_same(of_b) {
            self.add("ellipsoid", &of_a.name, &of_b.name);
        }
        self.check("prime meridian", a.meridian, b.meridian, ANGLE_TOLERANCE);
    }

    fn projection(&mut self, a: &Projection, b: &Projection) {
        let (Some(of_a), Some(of_b)) = (a.method, b.method) else {
            let is_same = a.method_name == b.method_name && a.parameters == b.parameters;
            return if !is_same {
                self.add("projection", &a.method_name, &b.method_name)
            };
        };
        if of_a != of_b {
            return self.add("projection", of_a.name, of_b.name);
        }
        for &(role, _) in of_a.parameters {
            use crate::crs::methods::Dimension::{Angle, Length, Ratio};
            let tolerance = match role.dimension() {
                Angle => ANGLE_TOLERANCE,
                Length => LENGTH_TOLERANCE,
                Ratio => RATIO_TOLERANCE,
            };
            self.check(role.name(), a.value(role), b.value(role), tolerance);
        }
    }

    fn vertical(&mut self, a: &Vertical, b: &Vertical) {
        if !a.unit.is_same(&b.unit) {
            self.add("unit of heights", &a.unit, &b.unit);
        }
        if a.is_only_unit() || b.is_only_unit() {
            return;
        }
        if a.is_depth != b.is_depth {
            let word = |one: &Vertical| if one.is_depth { "depths" } else { "heights" };
            self.add("direction of z", word(a), word(b));
        }
        let is_same = a.is_ellipsoidal == b.is_ellipsoidal
            && match (a.datum_code, b.datum_code) {
                (Some(a), Some(b)) => a == b,
                _ => a.is_ellipsoidal || is_same_datum(&a.datum, &b.datum),
            };
        if !is_same {
            self.add("heights", &a.name, &b.name);
        }
    }
}

impl Ellipsoid {
    /// Whether both have the same shape.
    pub(crate) fn is_same(&self, other: &Ellipsoid) -> bool {
        (self.semi_major - other.semi_major).abs() <= AXIS_TOLERANCE
            && (self.inverse_flattening - other.inverse_flattening).abs() <= FLATTENING_TOLERANCE
    }
}

impl Kind {
    fn name(&self) -> &'static str {
        match self {
            Kind::Geographic(_) => "geographic",
            Kind::Projected(..) => "projected",
            Kind::Geocentric(_) => "geocentric",
            Kind::Unresolved => "unknown",
        }
    }
}
