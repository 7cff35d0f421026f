//! Makes the same inputs in 4D everywhere: `inputs4 KIND SIZE FILE` writes little-endian quadruples of f64.
//!
//! | kind | size | points |
//! |---|---|---|
//! | grid4 | per cent | of a grid of 16^4 integers, in random order; larger parts extend smaller ones |
//! | random4 | points | with integer coordinates below 2^20 |

use std::fs::File;
use std::io::{BufWriter, Error, Result, Write};

use spmesh_bench::random::Random;

const SEED: u64 = 1;
const SIDE: u32 = 16;
const RANDOM_END: usize = 1 << 20;

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [kind, size, path] = &words[..] else {
        return Err(Error::other("usage: inputs4 grid4|random4 SIZE FILE"));
    };
    let size = size.parse::<usize>().map_err(Error::other)?;
    let mut random = Random(SEED);
    let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let mut put = |point: [f64; 4]| out.write_all(point.map(f64::to_le_bytes).as_flattened());
    match kind.as_str() {
        "grid4" if size <= 100 => sample(size, random).try_for_each(put)?,
        "grid4" => return Err(Error::other(format!("{size} per cent of a grid"))),
        "random4" => {
            (0..size).try_for_each(|_| put(std::array::from_fn(|_| random.below(RANDOM_END) as f64)))?;
        }
        _ => return Err(Error::other(format!("{kind}: no such kind of input"))),
    }
    out.flush()
}

/// A given percentage of the points of a grid, each at most once.
fn sample(percent: usize, mut random: Random) -> impl Iterator<Item = [f64; 4]> {
    let order = random.permutation(SIDE.pow(4) as usize);
    let count = order.len() * percent / 100;
    let point = |number: u32| std::array::from_fn(|axis| f64::from(number / SIDE.pow(axis as u32) % SIDE));
    order.into_iter().take(count).map(point)
}
