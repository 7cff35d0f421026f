//! The squares of a pyramid of tiles: where they are on the Earth.

use std::f64::consts::PI;

/// A place: longitude and latitude in degrees, and metres above the ellipsoid.
pub(super) type Place = [f64; 3];

/// Steps across a tile: coordinates in a tile are integers from 0 to this.
pub(super) const STEPS: i64 = 32_767;

/// How levels divide the Earth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scheme {
    /// By degrees (EPSG:4326): two tiles at level 0.
    Geographic,
    /// By squares of the Web Mercator projection (EPSG:3857): one tile at level 0.
    Mercator,
}

/// A tile, counted from the west and from the south.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct Tile {
    pub(super) y: u32,
    pub(super) x: u32,
}

impl Scheme {
    /// Columns of a level.
    pub(super) fn columns(self, level: u32) -> u32 {
        match self {
            Scheme::Geographic => 2 << level,
            Scheme::Mercator => 1 << level,
        }
    }

    /// Rows of a level.
    pub(super) fn rows(self, level: u32) -> u32 {
        1 << level
    }

    /// The longitude between columns. Nothing is rounded: a column is 360 over a power of two wide.
    pub(super) fn west(self, level: u32, column: u32) -> f64 {
        f64::from(column) * (360.0 / f64::from(self.columns(level))) - 180.0
    }

    /// The latitude between rows.
    pub(super) fn south(self, level: u32, row: u32) -> f64 {
        let part = f64::from(row) / f64::from(self.rows(level));
        match self {
            Scheme::Geographic => 180.0 * part - 90.0,
            Scheme::Mercator => (PI * (2.0 * part - 1.0)).sinh().atan().to_degrees(),
        }
    }

    /// Columns that longitudes from `min` to `max` may be in: those and a neighbour on each side.
    pub(super) fn columns_of(self, level: u32, min: f64, max: f64) -> std::ops::RangeInclusive<u32> {
        let count = self.columns(level);
        let of = |longitude: f64| (longitude + 180.0) / 360.0 * f64::from(count);
        near(of(min), of(max), count)
    }

    /// Rows that latitudes from `min` to `max` may be in: those and a neighbour on each side.
    pub(super) fn rows_of(self, level: u32, min: f64, max: f64) -> std::ops::RangeInclusive<u32> {
        let count = self.rows(level);
        let of = |latitude: f64| {
            let part = match self {
                Scheme::Geographic => (latitude + 90.0) / 180.0,
                Scheme::Mercator => (latitude.to_radians().tan().asinh() / PI + 1.0) / 2.0,
            };
            part * f64::from(count)
        };
        near(of(min), of(max), count)
    }

    /// Longitude and latitude of the corner, and of the opposite one.
    pub(super) fn corners(self, level: u32, tile: Tile) -> [[f64; 2]; 2] {
        let corner = |x, y| [self.west(level, x), self.south(level, y)];
        [corner(tile.x, tile.y), corner(tile.x + 1, tile.y + 1)]
    }

    /// How far a tile of a level may be from the surface, by the rule that viewers of quantized meshes
    /// assume: a quarter of the Equator at level 0 for 65 columns of points. Units: metres.
    pub fn assumed_error(self, level: u32) -> f64 {
        let columns = f64::from(self.columns(level));
        2.0 * PI * super::earth::SEMI_MAJOR * 0.25 / (65.0 * columns)
    }
}

/// Casts saturate, so any number is in the range.
fn near(min: f64, max: f64, count: u32) -> std::ops::RangeInclusive<u32> {
    ((min - 1.0) as u32).min(count - 1)..=((max + 1.0) as u32).min(count - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn borders_of_the_schemes_are_where_the_standards_have_them() {
        let geographic = Scheme::Geographic;
        assert_eq!((geographic.columns(0), geographic.rows(0)), (2, 1));
        assert_eq!(geographic.corners(1, Tile { x: 2, y: 1 }), [[0.0, 0.0], [90.0, 90.0]]);
        assert_eq!(Scheme::Mercator.columns(0), 1);
        let [[west, south], [east, north]] = Scheme::Mercator.corners(0, Tile { x: 0, y: 0 });
        assert_eq!((west, east, south), (-180.0, 180.0, -north));
        assert!((north - 85.051_128_779_806_6).abs() < 1e-12);
        assert_eq!(geographic.columns_of(3, 7.0, 8.0), 7..=9);
        assert_eq!(geographic.rows_of(0, -90.0, 90.0), 0..=0);
        assert!((geographic.assumed_error(0) - 77_067.34).abs() < 0.01);
    }
}
