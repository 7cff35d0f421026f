//! Systems from well-known text: WKT 1 of OGC, GDAL and ESRI, and WKT 2.

use crate::crs::epsg;
use crate::crs::methods::{Dimension, Method, Role};
use crate::crs::names::{is_empty, letters};
use crate::crs::system::{Ellipsoid, Geographic, Horizontal, Kind, Projection, System, Vertical};
use crate::crs::units::Unit;
use crate::crs::wkt::{Node, parse};

const COMPOUND: [&str; 2] = ["COMPD_CS", "COMPOUNDCRS"];
const PROJECTED: [&str; 3] = ["PROJCS", "PROJCRS", "PROJECTEDCRS"];
const GEOGRAPHIC: [&str; 5] = ["GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS"];
const BASE: [&str; 3] = ["GEOGCS", "BASEGEOGCRS", "BASEGEODCRS"];
const VERTICAL: [&str; 4] = ["VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS"];
const DATUM: [&str; 5] = ["DATUM", "ENSEMBLE", "GEODETICDATUM", "TRF", "GEODETICREFERENCEFRAME"];
const VERTICAL_DATUM: [&str; 5] =
    ["VERT_DATUM", "VDATUM", "ENSEMBLE", "VERTICALDATUM", "VERTICALREFERENCEFRAME"];
const ANGLE_UNIT: [&str; 2] = ["UNIT", "ANGLEUNIT"];
const LENGTH_UNIT: [&str; 2] = ["UNIT", "LENGTHUNIT"];
/// The type of a vertical datum in WKT 1 that makes heights ellipsoidal.
const ELLIPSOIDAL: f64 = 2002.;

/// The system that `text` defines. Text that cannot be read gives no system but a remark.
pub(crate) fn system(text: &str) -> System {
    let mut system = System::default();
    match parse(text) {
        Ok(nodes) => {
            system.title = nodes.first().map(|node| node.name().to_string()).filter(|name| !name.is_empty());
            nodes.iter().for_each(|node| system.add(node));
        }
        Err(fault) => system.remarks.push(format!("its well-known text cannot be read: {fault}")),
    }
    system
}

impl System {
    /// Adds what `node` defines.
    fn add(&mut self, node: &Node) {
        if node.is(&["BOUNDCRS"]) {
            let source = node.child(&["SOURCECRS"]).into_iter().flat_map(Node::children);
            return source.for_each(|node| self.add(node));
        }
        if node.is(&COMPOUND) {
            return self.add_compound(node);
        }
        if node.is(&VERTICAL) {
            self.add_vertical(node);
        } else if node.is(&PROJECTED) || node.is(&GEOGRAPHIC) || node.is(&["GEOCCS"]) {
            self.add_horizontal(node);
        } else {
            let (kind, name) = (node.keyword, node.name());
            self.remarks.push(format!("it is of the kind {kind} ({name}), which has no place on the Earth"));
        }
    }

    /// The parts, or what the code of the whole stands for if there are none.
    fn add_compound(&mut self, node: &Node) {
        let is_about =
            |part: &Node| part.is(&["AUTHORITY", "ID", "USAGE", "SCOPE", "AREA", "BBOX", "REMARK"]);
        node.children().filter(|part| !is_about(part)).for_each(|part| self.add(part));
        // Every definition of the dataset has parts, so this ends.
        if node.children().all(is_about)
            && let Some(whole) = node.code().and_then(epsg::system)
        {
            *self = whole;
        }
    }

    fn add_horizontal(&mut self, node: &Node) {
        let (name, code) = (node.name().to_string(), node.code());
        let base_node = node.child(&BASE).unwrap_or(node);
        let Some(base) = geographic(base_node) else {
            self.remarks.push(format!("{name:?} has no datum with an ellipsoid"));
            let unit = length_unit(node).unwrap_or_else(Unit::metre);
            return self.horizontal = code.map(|_| Horizontal { name, code, kind: Kind::Unresolved, unit });
        };
        if let Some(strange) = unit_of_axes(base_node, &ANGLE_UNIT).filter(|unit| is_length(unit)) {
            self.remarks.push(format!("its unit of angles is called {:?}: taking degrees", strange.name()));
        }
        let axes = node.child(&["CS"]);
        let is_cartesian = axes.is_some_and(|cs| cs.values.first().is_some_and(|kind| kind.is("cartesian")));
        let (kind, unit) = if node.is(&PROJECTED) {
            let unit = length_unit(node).unwrap_or_else(Unit::metre);
            let projection = self.projection(node, &base, &unit);
            (Kind::Projected(base, projection), unit)
        } else if node.is(&["GEOCCS"]) || is_cartesian {
            (Kind::Geocentric(base), length_unit(node).unwrap_or_else(Unit::metre))
        } else {
            let unit = base.unit.clone();
            (Kind::Geographic(base), unit)
        };
        let is_solid = axes.and_then(|cs| cs.number(1)) == Some(3.) && !matches!(kind, Kind::Geocentric(_));
        self.horizontal = Some(Horizontal { name, code, kind, unit });
        if is_solid {
            self.vertical = Some(Vertical::ellipsoidal(height_unit(node)));
        }
        // ESRI's tools also write a vertical system into the horizontal one.
        if let Some(inner) = node.child(&VERTICAL) {
            self.add_vertical(inner);
        }
    }

    fn add_vertical(&mut self, node: &Node) {
        let vertical = vertical(node);
        let stated = unit_of_axes(node, &LENGTH_UNIT).map(Node::name).and_then(Unit::of_name);
        if let Some(stated) = stated.filter(|stated| !stated.is_same(&vertical.unit)) {
            let (name, size) = (&vertical.name, vertical.unit.size);
            self.remarks.push(format!(
                "the unit of {name:?} is called {stated}, but its size is that of {size} metres"
            ));
        }
        self.vertical = Some(vertical);
    }

    fn projection(&mut self, node: &Node, base: &Geographic, unit: &Unit) -> Projection {
        let conversion = node.child(&["CONVERSION"]).unwrap_or(node);
        let method_name = conversion.child(&["PROJECTION", "METHOD"]).map(Node::name).unwrap_or_default();
        let (mut parameters, mut others) = (Vec::new(), Vec::new());
        for parameter in conversion.children().filter(|child| child.is(&["PARAMETER"])) {
            match (Role::of_name(parameter.name()), parameter.number(1)) {
                (Some(role), Some(value)) => {
                    parameters.push((role, in_base_unit(role, value, parameter, base, unit)));
                }
                (None, Some(value)) if value != 0. => others.push(parameter.name().to_string()),
                _ => {}
            }
        }
        // GDAL writes the sphere of web maps as a string of PROJ.
        let is_web = node.child(&["EXTENSION"]).is_some_and(|extension| {
            extension.values.iter().any(|value| value.contains("+b=6378137 ") || value.contains("@null"))
        });
        let name = if is_web { "Popular Visualisation Pseudo Mercator" } else { method_name };
        let method = Method::of_name(name, &parameters);
        if let Some(method) = method {
            method.own_roles(&mut parameters);
        }
        Projection { method_name: method_name.to_string(), method, parameters, others }
    }
}

/// The value of a parameter in degrees or metres. Its unit is its own in WKT 2, else that of the system.
fn in_base_unit(role: Role, value: f64, node: &Node, base: &Geographic, unit: &Unit) -> f64 {
    match role.dimension() {
        Dimension::Angle => {
            let own = node.child(&["ANGLEUNIT"]).and_then(angle_unit_of);
            own.as_ref().unwrap_or(&base.unit).degrees(value)
        }
        Dimension::Length => {
            let own = node.child(&["LENGTHUNIT"]).and_then(length_unit_of);
            value * own.as_ref().unwrap_or(unit).size
        }
        Dimension::Ratio => value,
    }
}

fn geographic(node: &Node) -> Option<Geographic> {
    let datum = node.child(&DATUM)?;
    let ellipsoid = datum.child(&["SPHEROID", "ELLIPSOID"])?;
    let unit = unit_of_axes(node, &ANGLE_UNIT).filter(|unit| !is_length(unit));
    let unit = unit.and_then(angle_unit_of).or_else(|| unit_of_base(node)).unwrap_or_else(Unit::degree);
    let meridian = node.child(&["PRIMEM", "PRIMEMERIDIAN"]);
    let longitude = meridian.and_then(|node| node.number(1)).unwrap_or(0.);
    let own = meridian.and_then(|node| node.child(&["ANGLEUNIT"])).and_then(angle_unit_of);
    // WKT 1 of GDAL states the meridian in degrees, whatever the unit of the system.
    let longitude = own.map_or(longitude, |own| own.degrees(longitude));
    Some(Geographic {
        name: node.name().to_string(),
        code: node.code(),
        datum: datum.name().to_string(),
        datum_code: datum.code(),
        ellipsoid: Ellipsoid {
            name: ellipsoid.name().to_string(),
            semi_major: ellipsoid.number(1)?
                * ellipsoid.child(&["LENGTHUNIT"]).and_then(length_unit_of).map_or(1., |unit| unit.size),
            inverse_flattening: ellipsoid.number(2)?,
        },
        meridian: longitude,
        unit,
    })
}

/// The unit of angles of the base of a projected system, which WKT 2 does not repeat.
fn unit_of_base(node: &Node) -> Option<Unit> {
    let is_base = node.is(&["BASEGEOGCRS", "BASEGEODCRS"]);
    let text = node.code().filter(|_| is_base).and_then(epsg::text)?;
    unit_of_axes(parse(text).ok()?.first()?, &ANGLE_UNIT).and_then(angle_unit_of)
}

fn vertical(node: &Node) -> Vertical {
    let base = node.child(&["BASEVERTCRS"]).unwrap_or(node);
    let datum = base.child(&VERTICAL_DATUM);
    let is_ellipsoidal = datum.map_or(base.child(&DATUM).is_some(), |datum| {
        datum.number(1) == Some(ELLIPSOIDAL) || datum.name().eq_ignore_ascii_case("Ellipsoid")
    });
    let direction = node
        .children()
        .find(|child| child.is(&["PARAMETER"]) && child.name().eq_ignore_ascii_case("Direction"));
    let axis = node.child(&["AXIS"]);
    let unit = unit_of_axes(node, &LENGTH_UNIT).and_then(length_unit_of).unwrap_or_else(Unit::metre);
    let stated = Vertical {
        name: node.name().to_string(),
        code: node.code(),
        datum: datum.map(Node::name).unwrap_or_default().to_string(),
        datum_code: datum.and_then(Node::code),
        unit,
        is_ellipsoidal,
        is_depth: direction.and_then(|node| node.number(1)) == Some(-1.)
            || axis.is_some_and(|axis| axis.values.iter().any(|value| value.is("down"))),
    };
    if is_empty(&stated.name) && is_empty(&stated.datum) && is_ellipsoidal {
        return Vertical::ellipsoidal(stated.unit);
    }
    stated
}

fn length_unit(node: &Node) -> Option<Unit> {
    unit_of_axes(node, &LENGTH_UNIT).and_then(length_unit_of)
}

/// The unit of the heights of a system in three dimensions: that of its third axis.
fn height_unit(node: &Node) -> Unit {
    let axis = node.children().filter(|child| child.is(&["AXIS"])).nth(2);
    let own = axis.and_then(|axis| axis.child(&["LENGTHUNIT"])).and_then(length_unit_of);
    own.or_else(|| node.child(&["LENGTHUNIT"]).and_then(length_unit_of)).unwrap_or_else(Unit::metre)
}

/// The unit of a system, or else that of its first axis.
fn unit_of_axes<'n, 't>(node: &'n Node<'t>, keywords: &[&str]) -> Option<&'n Node<'t>> {
    node.child(keywords).or_else(|| node.child(&["AXIS"])?.child(keywords))
}

fn length_unit_of(node: &Node) -> Option<Unit> {
    node.number(1).filter(|&size| size > 0.).map(|size| Unit::length(node.name(), size))
}

/// Whether the name of a unit is that of a length, which some writers give to angles.
fn is_length(unit: &Node) -> bool {
    ["metre", "metres", "meter", "meters"].contains(&&letters(unit.name())[..])
}

fn angle_unit_of(node: &Node) -> Option<Unit> {
    node.number(1).filter(|&size| size > 0.).map(|size| Unit::angle(node.name(), size))
}
