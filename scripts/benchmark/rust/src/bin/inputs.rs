//! Makes the same inputs everywhere. `inputs uniform COUNT FILE`, `inputs grid SIDE FILE` and `inputs
//! decimals SIDE FILE` write little-endian pairs of f64 in random order. `inputs permute FROM.las FILE`
//! writes the points of an uncompressed LAS file in random order.

use std::fs::File;
use std::io::{BufWriter, Error, Read, Result, Write};

use spmesh_bench::LasHeader;
use spmesh_bench::random::Random;

const SEED: u64 = 1;

fn main() -> Result<()> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [kind, what, path] = &words[..] else {
        return Err(Error::other("usage: inputs uniform|grid|decimals|permute COUNT|SIDE|FROM FILE"));
    };
    let mut out = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let number = || what.parse::<usize>().map_err(Error::other);
    match kind.as_str() {
        "uniform" => uniform(number()?, &mut out)?,
        "grid" => grid(number()?, 1.0, &mut out)?,
        "decimals" => grid(number()?, 10.0, &mut out)?,
        "permute" => permute(what, &mut out)?,
        _ => return Err(Error::other(format!("{kind}: no such kind of input"))),
    }
    out.flush()
}

/// Random points in the unit square.
fn uniform(count: usize, out: &mut impl Write) -> Result<()> {
    let mut random = Random(SEED);
    for _ in 0..2 * count {
        out.write_all(&random.unit().to_le_bytes())?;
    }
    Ok(())
}

/// All integer points in a square, divided by a number. Tenths are rounded, so ties become near ties.
fn grid(side: usize, divisor: f64, out: &mut impl Write) -> Result<()> {
    for number in Random(SEED).permutation(side * side) {
        let (column, row) = (number as usize % side, number as usize / side);
        out.write_all(&(column as f64 / divisor).to_le_bytes())?;
        out.write_all(&(row as f64 / divisor).to_le_bytes())?;
    }
    Ok(())
}

fn permute(from: &str, out: &mut impl Write) -> Result<()> {
    let mut file = File::open(from)?;
    let header = LasHeader::read(&mut file)?;
    let mut records = vec![0; header.points * header.record_len];
    file.read_exact(&mut records)?;
    out.write_all(&header.bytes)?;
    for number in Random(SEED).permutation(header.points) {
        let start = number as usize * header.record_len;
        out.write_all(&records[start..start + header.record_len])?;
    }
    Ok(())
}
