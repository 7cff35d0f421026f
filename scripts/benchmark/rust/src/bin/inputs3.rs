//! Makes the same inputs in 3D everywhere: `inputs3 KIND SIZE FILE` writes little-endian triples of f64.
//!
//! | kind | size | points |
//! |---|---|---|
//! | uniform3 | points | of the unit cube |
//! | protein3 | points | dense packing, see `packed`; unit 0.001 angstrom |
//! | angstrom3 | points | the same, unit 1 angstrom |
//! | surface3 | points | of a sphere with bumps, see `bumpy` |
//! | tenbit3 | points | with integer coordinates below 1024, some of them equal |
//! | grid3 | side | of a cubic grid of side^3 integers, in random order |
//! | fcc3 | side | of a face-centred cubic grid of side^3 cells with 4 points each, in random order |

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{BufWriter, Error, Result, Write};

use spmesh_bench::random::Random;

const SEED: u64 = 1;

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [kind, size, path] = &words[..] else {
        return Err(Error::other(
            "usage: inputs3 uniform3|protein3|angstrom3|surface3|tenbit3|grid3|fcc3 SIZE FILE",
        ));
    };
    let size = size.parse::<usize>().map_err(Error::other)?;
    let mut random = Random(SEED);
    let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let mut put = |point: [f64; 3]| out.write_all(bytes_of(point).as_flattened());
    match kind.as_str() {
        "uniform3" => (0..size).try_for_each(|_| put(std::array::from_fn(|_| random.unit())))?,
        "protein3" => packed(size, random).into_iter().try_for_each(|point| put(point.map(f64::from)))?,
        "angstrom3" => {
            packed(size, random)
                .into_iter()
                .try_for_each(|point| put(point.map(|x| f64::from(x) / 1000.0)))?;
        }
        "surface3" => (0..size).try_for_each(|_| put(bumpy(&mut random)))?,
        "tenbit3" => (0..size).try_for_each(|_| put(std::array::from_fn(|_| random.below(1024) as f64)))?,
        "grid3" => grid(size, &[[0, 0, 0]], 1, random).try_for_each(put)?,
        "fcc3" => grid(size, &[[0, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0]], 2, random).try_for_each(put)?,
        _ => return Err(Error::other(format!("{kind}: no such kind of input"))),
    }
    out.flush()
}

fn bytes_of(point: [f64; 3]) -> [[u8; 8]; 3] {
    point.map(f64::to_le_bytes)
}

/// A point on a sphere whose radius varies by a fifth.
fn bumpy(random: &mut Random) -> [f64; 3] {
    let (z, angle) = (2.0 * random.unit() - 1.0, TAU * random.unit());
    let across = (1.0 - z * z).sqrt();
    let direction = [across * angle.cos(), across * angle.sin(), z];
    let [x, y, z] = direction.map(|x| (5.0 * x).sin());
    direction.map(|c| c * (1.0 + 0.1 * (x * y + y * z + z * x)))
}

/// All points of `side`^3 cells of a grid, in random order.
fn grid(side: usize, of_cell: &[[u32; 3]], step: u32, mut random: Random) -> impl Iterator<Item = [f64; 3]> {
    let cells = side * side * side;
    let order = random.permutation(cells * of_cell.len());
    order.into_iter().map(move |number| {
        let (cell, point) = (number as usize % cells, of_cell[number as usize / cells]);
        let corner = [cell % side, cell / side % side, cell / side / side];
        std::array::from_fn(|axis| f64::from(corner[axis] as u32 * step + point[axis]))
    })
}

/// Points in a cube in random order, packed like the atoms of a protein or of water: integers in units of
/// 0.001 angstrom, about 0.1 points per cubic angstrom, no two nearer than `NEAREST`. Random points are taken
/// unless an earlier one is too near (random sequential adsorption).
fn packed(count: usize, mut random: Random) -> Vec<[i32; 3]> {
    const NEAREST: i64 = 1400;
    const ROOM: f64 = 10.0e9;
    let side = (count as f64 * ROOM).cbrt().ceil() as usize;
    // A cell of the index is so small that it holds at most one point.
    let cell = (NEAREST as f64 / 3f64.sqrt()).floor() as usize;
    let cells = side / cell + 1;
    let mut index = vec![u32::MAX; cells * cells * cells];
    let mut points: Vec<[i32; 3]> = Vec::with_capacity(count);
    while points.len() < count {
        let point: [usize; 3] = std::array::from_fn(|_| random.below(side));
        let place = point.map(|x| x / cell);
        if !near(&points, &index, cells, place, point.map(|x| x as i64), NEAREST) {
            index[(place[2] * cells + place[1]) * cells + place[0]] = points.len() as u32;
            points.push(point.map(|x| x as i32));
        }
    }
    points
}

/// Whether a point is nearer than `nearest` to one of `points`, which must be in a cell at most two away.
fn near(
    points: &[[i32; 3]],
    index: &[u32],
    cells: usize,
    place: [usize; 3],
    point: [i64; 3],
    nearest: i64,
) -> bool {
    let around = |axis: usize| place[axis].saturating_sub(2)..(place[axis] + 3).min(cells);
    around(2).any(|z| {
        around(1).any(|y| {
            around(0).any(|x| {
                points.get(index[(z * cells + y) * cells + x] as usize).is_some_and(|other| {
                    let squares = (0..3).map(|axis| (point[axis] - i64::from(other[axis])).pow(2));
                    squares.sum::<i64>() < nearest * nearest
                })
            })
        })
    })
}
