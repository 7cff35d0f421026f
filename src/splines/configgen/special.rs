//! Kinds of special configurations, and the coordinates they need.

use std::str::FromStr;

use super::sites::Sites;
use spmesh_base::error::Result;
use spmesh_configurations::Knots;
use spmesh_configurations::special::{self, Features, Patch, Special, ZpSplit};
use spmesh_stream::Coordinates;

/// Special configurations for splines with sharp or box-spline parts (thesis, chapter 8).
#[derive(Debug, Clone, PartialEq)]
pub enum SpecialKind {
    /// Box splines on squares of the integer grid (figure 8.3).
    Boxes(ZpSplit),
    /// Box splines on grids, with the knots of the input between them (8.2.5).
    Patches(Vec<Patch>, ZpSplit),
    /// Sharp corners, creases and linear elements (8.3.1).
    Features(Features),
}

/// The value of `--box`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct BoxName(pub ZpSplit);

impl FromStr for BoxName {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let (is_falling, is_upright) = match text {
            "zp" => (false, false),
            "zp:falling" => (true, false),
            "zp:upright" => (false, true),
            "zp:falling:upright" => (true, true),
            _ => return Err("expected zp, zp:falling, zp:upright or zp:falling:upright".into()),
        };
        Ok(BoxName(ZpSplit { is_falling, is_upright }))
    }
}

impl SpecialKind {
    /// Whether it brings knots of its own, so that the input may be empty.
    pub(super) fn has_knots(&self) -> bool {
        matches!(self, SpecialKind::Patches(..))
    }

    /// The same sites in coordinates in which knots can be added.
    pub(super) fn place(&self, sites: Sites) -> Sites {
        match self {
            SpecialKind::Boxes(_) => sites.in_world(),
            SpecialKind::Patches(..) => {
                let mut sites = sites.in_world();
                sites.frame.elevations = None;
                sites
            }
            SpecialKind::Features(features)
                if features.creases.iter().all(|crease| crease.has_sharp_ends) =>
            {
                sites
            }
            SpecialKind::Features(_) => sites.with_room_for_middles(),
        }
    }

    /// Special configurations of knots, with the knots that they add.
    pub(super) fn set_up(&self, knots: &Knots) -> Result<Special> {
        match self {
            SpecialKind::Boxes(split) => special::zp(knots, *split),
            SpecialKind::Patches(patches, split) => special::patches(patches, knots.points(), *split),
            SpecialKind::Features(features) => special::features(knots, features),
        }
    }
}

impl Sites {
    /// The same sites in world coordinates.
    fn in_world(mut self) -> Sites {
        let coordinates = std::mem::replace(&mut self.frame.coordinates, Coordinates::F64);
        for point in &mut self.points {
            let [x, y, _] = coordinates.to_world([point[0], point[1], 0.0]);
            *point = [x, y];
        }
        for elevation in self.frame.elevations.iter_mut().flatten() {
            *elevation = coordinates.to_world([0.0, 0.0, *elevation])[2];
        }
        self
    }

    /// The same sites in coordinates that can hold midpoints: a grid becomes twice as fine, if it then fits
    /// 32 bits.
    fn with_room_for_middles(mut self) -> Sites {
        let Coordinates::I32 { scale, offset } = self.frame.coordinates else { return self };
        let numbers = self.points.as_flattened().iter().chain(self.frame.elevations.iter().flatten());
        if numbers.into_iter().any(|number| 2.0 * number.abs() > f64::from(i32::MAX)) {
            return self.in_world();
        }
        self.points.as_flattened_mut().iter_mut().for_each(|number| *number *= 2.0);
        self.frame.elevations.iter_mut().flatten().for_each(|number| *number *= 2.0);
        self.frame.coordinates = Coordinates::I32 { scale: scale.map(|unit| unit / 2.0), offset };
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_have_two_splits() {
        assert_eq!("zp".parse(), Ok(BoxName::default()));
        let both = ZpSplit { is_falling: true, is_upright: true };
        assert_eq!("zp:falling:upright".parse(), Ok(BoxName(both)));
        for word in ["", "zp:", "zp:upright:falling", "bezier"] {
            assert!(word.parse::<BoxName>().is_err(), "{word}");
        }
    }
}
