//! Whether the regions of partial meshes leave a gap, in which points of a forgotten part may lie.

use std::io::Read;

use super::merge::{check_together, region_of};
use super::partial::Part;
use spmesh_base::error::Result;
use spmesh_stream::model::bounds::Region;
use spmesh_stream::{Coordinates, StreamReader};

/// A box in world coordinates that should be covered by the regions of `readers`, and lies in none of them:
/// the part of it was probably forgotten. `None` if there is no such box.
///
/// The regions should cover `part`. Without it, they should cover the smallest box around them. If a region is
/// unbounded along an axis, so is that box, in both directions: a part without its other half has a gap.
///
/// Cost: a sort of the sides of the regions along each axis, for rows of regions like those of a raster.
///
/// # Errors
/// As [`super::merge_triangles`], if the inputs do not fit together, or the box of `part` is empty.
pub fn missing_region<R: Read, const D: usize>(
    readers: &[StreamReader<R>],
    part: Option<Part<D>>,
) -> Result<Option<Region<D>>> {
    let Some(first) = readers.first() else { return Ok(None) };
    // Streams of other dimensions cannot be merged at all.
    if readers.iter().any(|reader| usize::from(reader.header().dims) != D) {
        return Ok(None);
    }
    check_together::<R, D>(readers)?;
    let regions: Vec<Region<D>> = readers.iter().map(|reader| region_of(reader.header())).collect();
    let part = part.map(|part| part.region(first.header())).transpose()?;
    let whole = part.unwrap_or_else(|| around(&regions));
    Ok(gap(whole, &regions).map(|gap| in_world(&gap, &first.header().coordinates)))
}

/// The smallest box around the regions, or larger where one of them is unbounded.
fn around<const D: usize>(regions: &[Region<D>]) -> Region<D> {
    let mut whole = regions[0];
    for axis in 0..D {
        for region in regions {
            whole.min[axis] = whole.min[axis].min(region.min[axis]);
            whole.max[axis] = whole.max[axis].max(region.max[axis]);
        }
        if whole.min[axis].is_infinite() || whole.max[axis].is_infinite() {
            (whole.min[axis], whole.max[axis]) = (f64::NEG_INFINITY, f64::INFINITY);
        }
    }
    whole
}

/// A box in `whole` that no region overlaps, as large as possible along each axis in turn.
fn gap<const D: usize>(whole: Region<D>, regions: &[Region<D>]) -> Option<Region<D>> {
    let mut gap = uncovered(whole, &regions.iter().collect::<Vec<_>>(), 0)?;
    for axis in 0..D {
        let mut column = gap;
        (column.min[axis], column.max[axis]) = (whole.min[axis], whole.max[axis]);
        let (low, high) = (gap.min[axis], gap.max[axis]);
        (gap.min[axis], gap.max[axis]) = (whole.min[axis], whole.max[axis]);
        for region in regions.iter().filter(|region| region.overlaps(&column)) {
            if region.max[axis] <= low {
                gap.min[axis] = gap.min[axis].max(region.max[axis]);
            }
            if region.min[axis] >= high {
                gap.max[axis] = gap.max[axis].min(region.min[axis]);
            }
        }
    }
    Some(gap)
}

/// A box in `whole` that no region overlaps. The regions span `whole` along the axes before `axis`.
fn uncovered<const D: usize>(whole: Region<D>, regions: &[&Region<D>], axis: usize) -> Option<Region<D>> {
    if regions.is_empty() {
        return Some(whole);
    }
    if axis == D {
        return None;
    }
    // Between two neighbouring sides, each region is all there or not at all.
    let (low, high) = (whole.min[axis], whole.max[axis]);
    let sides = regions.iter().flat_map(|region| [region.min[axis], region.max[axis]]);
    let mut sides: Vec<f64> = sides.filter(|&side| low < side && side < high).chain([low, high]).collect();
    sides.sort_unstable_by(f64::total_cmp);
    sides.dedup();
    sides.windows(2).find_map(|pair| {
        let mut slab = whole;
        (slab.min[axis], slab.max[axis]) = (pair[0], pair[1]);
        let inside: Vec<&Region<D>> =
            regions.iter().copied().filter(|region| region.overlaps(&slab)).collect();
        uncovered(slab, &inside, axis + 1)
    })
}

fn in_world<const D: usize>(stored: &Region<D>, coordinates: &Coordinates) -> Region<D> {
    let stored = stored.in_space();
    let [min, max] = [stored.min, stored.max].map(|corner| coordinates.to_decimal(corner));
    Region::between(min, max)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INF: f64 = f64::INFINITY;

    fn region(min: [f64; 2], max: [f64; 2]) -> Region {
        Region { min, max }
    }

    /// The tiles of a grid of unit squares.
    fn grid(columns: u32, rows: u32) -> Vec<Region> {
        let places = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row].map(f64::from)));
        places.map(|min| Region { min, max: min.map(|side| side + 1.0) }).collect()
    }

    #[test]
    fn any_tile_of_a_grid_is_missed() {
        let tiles = grid(4, 3);
        assert_eq!(gap(around(&tiles), &tiles), None);
        for missing in 0..tiles.len() {
            let mut others = tiles.clone();
            let tile = others.remove(missing);
            assert_eq!(gap(around(&tiles), &others), Some(tile));
        }
    }

    #[test]
    fn gaps_are_as_large_as_they_can_be() {
        // A missing column beside rows of different heights.
        let tiles =
            [region([0.0, 0.0], [1.0, 2.0]), region([0.0, 2.0], [1.0, 3.0]), region([2.0, 0.0], [3.0, 3.0])];
        assert_eq!(gap(around(&tiles), &tiles), Some(region([1.0, 0.0], [2.0, 3.0])));
        let half = [region([-INF, -INF], [7.0, INF])];
        assert_eq!(gap(around(&half), &half), Some(region([7.0, -INF], [INF, INF])));
        let finite = [region([0.0, 0.0], [7.0, 1.0])];
        assert_eq!(gap(around(&finite), &finite), None);
        assert_eq!(gap(region([0.0, 0.0], [9.0, 1.0]), &finite), Some(region([7.0, 0.0], [9.0, 1.0])));
    }

    #[test]
    fn slits_and_pinwheels_are_found() {
        let sides = region([0.0, 0.0], [3.0, 3.0]);
        let pinwheel = [
            region([0.0, 0.0], [2.0, 1.0]),
            region([2.0, 0.0], [3.0, 2.0]),
            region([1.0, 2.0], [3.0, 3.0]),
            region([0.0, 1.0], [1.0, 3.0]),
        ];
        assert_eq!(gap(sides, &pinwheel), Some(region([1.0, 1.0], [2.0, 2.0])));
        let slit = [region([0.0, 0.0], [1.0, 3.0]), region([1f64.next_up(), 0.0], [3.0, 3.0])];
        assert_eq!(gap(sides, &slit).map(|gap| gap.min[0]), Some(1.0));
    }
}
