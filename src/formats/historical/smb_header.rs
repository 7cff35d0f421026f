//! The header of SMB, and the detection of its byte order.

use crate::raw::byte_order::{ByteOrder, parse_in_either};
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

pub(crate) const ELEMENTS_PER_BLOCK: usize = 32;
/// Three floats or three vertex numbers.
pub(crate) const ELEMENT_LEN: usize = 12;

const VERSION: u8 = 0;

/// Three floats, 12 bytes.
pub(crate) fn point(order: ByteOrder, bytes: &[u8]) -> Point {
    std::array::from_fn(|axis| f64::from(f32::from_bits(order.u32(&bytes[axis * 4..]))))
}

/// What the header states.
#[derive(Debug, Clone)]
pub(crate) struct SmbHeader {
    /// Byte order of all numbers.
    pub(crate) order: ByteOrder,
    pub(crate) vertices: Option<u64>,
    pub(crate) triangles: Option<u64>,
    /// Length in bytes.
    pub(crate) len: usize,
    bounds: Option<[Point; 2]>,
}

/// Reads the header from the first bytes of a file, in the more plausible byte order; if both are equally
/// plausible, in the order that the file's flag states.
pub(crate) fn read_header(head: &[u8]) -> Result<SmbHeader> {
    parse_in_either(
        head,
        |order| parse_header(head, order),
        |header| plausibility(header, &head[header.len..]),
    )
}

fn parse_header(head: &[u8], order: ByteOrder) -> Result<SmbHeader> {
    let mut rest = head;
    let mut take = |len: usize| -> Result<&[u8]> {
        let missing =
            || Error::malformed(format!("truncated: expected {len} bytes more, found {}", rest.len()));
        let (bytes, after) = rest.split_at_checked(len).ok_or_else(missing)?;
        rest = after;
        Ok(bytes)
    };
    let start = take(4)?;
    if start[0] != VERSION || start[1] > 1 || start[2..] != [0, 0] {
        return Err(Error::malformed(format!("first bytes {start:?} are not those of uncompressed SMB")));
    }
    for _ in 0..order.u32(take(4)?) {
        let len = order.u32(take(4)?) as usize;
        take(len)?;
    }
    let mut count = || match order.u32(take(4)?) as i32 {
        -1 => Ok(None),
        count => match u64::try_from(count) {
            Ok(count) => Ok(Some(count)),
            Err(_) => Err(Error::malformed(format!("the header states a count of {count}"))),
        },
    };
    let (vertices, triangles) = (count()?, count()?);
    let bounds = match take(1)?[0] {
        0 => None,
        _ => {
            let (min, max) = (point(order, take(ELEMENT_LEN)?), point(order, take(ELEMENT_LEN)?));
            if !(0..3).all(|axis| min[axis] <= max[axis]) {
                return Err(Error::malformed(format!("bounding box from {min:?} to {max:?}")));
            }
            Some([min, max])
        }
    };
    let len = head.len() - rest.len();
    Ok(SmbHeader { order, vertices, triangles, len, bounds })
}

/// How plausible header and first block are as a mesh in this byte order: coordinates of ordinary magnitude
/// within the bounding box, and triangles of existing vertices. Numbers of vertices that may come later
/// (post-order) weigh little, because byte-swapped small floats look like them.
fn plausibility(header: &SmbHeader, body: &[u8]) -> u32 {
    let order = header.order;
    let is_ordinary = |x: &&f64| **x == 0.0 || (1e-9..1e9).contains(&x.abs());
    let ordinary = |point: Point| 3 * point.iter().filter(is_ordinary).count() as u32;
    let is_small = |count: Option<u64>| u32::from(count.is_none_or(|count| count < 1 << 24));
    let mut score = is_small(header.vertices) + is_small(header.triangles);
    score += header.bounds.map_or(0, |[min, max]| ordinary(min) + ordinary(max));
    let Some((descriptor, elements)) = body.split_at_checked(4) else { return score };
    let descriptor = order.u32(descriptor);
    let is_pre_order = descriptor & 1 == 1;
    let mut vertices = 0;
    for (index, element) in elements.chunks_exact(ELEMENT_LEN).take(ELEMENTS_PER_BLOCK).enumerate() {
        if descriptor >> index & 1 == 1 {
            let point = point(order, element);
            let is_inside = |[min, max]: [Point; 2]| (0..3).all(|i| min[i] <= point[i] && point[i] <= max[i]);
            score += ordinary(point) + 3 * u32::from(header.bounds.is_some_and(is_inside));
            vertices += 1;
        } else {
            let (limit, weight) = if is_pre_order { (vertices, 3) } else { (1 << 20, 1) };
            let numbers = element.chunks_exact(4).map(|bytes| i64::from(order.u32(bytes) as i32).abs());
            score += numbers.filter(|number| (1..=limit).contains(number)).count() as u32 * weight;
        }
    }
    score
}
