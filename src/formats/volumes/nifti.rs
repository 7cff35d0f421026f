//! NIfTI-1: a header of 348 bytes, then the values (nifti1.h of the NIfTI Data Format Working Group, 2007).
//!
//! The `nifti` crate would add arrays and linear algebra as dependencies; a dozen fields are all that is
//! needed here.

use crate::raw::byte_order::ByteOrder;
use crate::raw::sample::SampleType;
use crate::source::origin::Origin;
use crate::volumes::data::{Data, Encoding, Part, Skip};
use crate::volumes::lattice::Lattice;
use crate::volumes::volume::{Volume, units_of};
use crate::volumes::world::World;
use spmesh_base::error::{Error, Result};
use spmesh_stream::model::bounds::Point;

/// Length of the header, which its first four bytes state.
const HEADER_LEN: u32 = 348;

/// Length of a NIfTI-2 header.
const HEADER2_LEN: u32 = 540;

/// Offset of the magic bytes.
const MAGIC_AT: usize = 344;

/// Reads the header of a volume.
pub(crate) fn open(origin: Origin, head: &[u8], warnings: &mut Vec<String>) -> Result<Volume> {
    let is_gzip = origin.plain()?.is_compressed();
    let order = if head[0] == 0 { ByteOrder::Big } else { ByteOrder::Little };
    let header = Header { bytes: head, order };
    if order.u32(head) == HEADER2_LEN {
        return Err(Error::malformed("is NIfTI-2: convert it to NIfTI-1 first"));
    }
    if head.get(MAGIC_AT..MAGIC_AT + 4) != Some(b"n+1\0") {
        let message = "is the header of a pair of files (.hdr and .img): convert it to one file (.nii) first";
        return Err(Error::malformed(message));
    }
    let lens = header.lens()?;
    if lens[3] == 1 {
        warnings.push("the volume has one time step: all points have t = 0".to_string());
    }
    let sample = header.sample()?;
    let lattice = Lattice::new(lens)?;
    let part = Part { origin, name: None, is_gzip, header_len: header.data_start()? };
    Ok(Volume {
        lattice,
        data: Data {
            parts: vec![part],
            sample,
            encoding: Encoding::Raw(order),
            line_skip: 0,
            byte_skip: Skip::Bytes(0),
            is_exact: false,
        },
        scaling: header.scaling()?,
        world: header.world(),
        units: header.units(),
    })
}

/// Fields of the header, by their offsets.
struct Header<'b> {
    bytes: &'b [u8],
    order: ByteOrder,
}

impl Header<'_> {
    fn i16(&self, at: usize) -> i16 {
        self.order.u16(&self.bytes[at..]) as i16
    }

    fn f32(&self, at: usize) -> f32 {
        f32::from_bits(self.order.u32(&self.bytes[at..]))
    }

    /// Sizes of x, y, z and t (`dim`).
    fn lens(&self) -> Result<[u64; 4]> {
        let dimensions = self.i16(40);
        if !(1..=7).contains(&dimensions) {
            let message = format!("found {dimensions} dimensions, expected 3 or 4");
            return Err(Error::malformed(message).at("dim[0]"));
        }
        let mut lens = [1; 4];
        for axis in 1..=dimensions as usize {
            let len = self.i16(40 + 2 * axis);
            if len < 1 {
                return Err(Error::malformed(format!("found size {len}, expected 1 or more"))
                    .at(format!("dim[{axis}]")));
            }
            match lens.get_mut(axis - 1) {
                Some(known) => *known = len as u64,
                None if len == 1 => {}
                None => {
                    let message = format!("a fifth dimension of size {len}: values must be single numbers");
                    return Err(Error::malformed(message).at(format!("dim[{axis}]")));
                }
            }
        }
        Ok(lens)
    }

    /// Type of the values (`datatype`).
    fn sample(&self) -> Result<SampleType> {
        let sample = match self.i16(70) {
            2 => SampleType::U8,
            4 => SampleType::I16,
            8 => SampleType::I32,
            16 => SampleType::F32,
            64 => SampleType::F64,
            256 => SampleType::I8,
            512 => SampleType::U16,
            768 => SampleType::U32,
            1024 => SampleType::I64,
            1280 => SampleType::U64,
            other => {
                let message =
                    format!("values are of type {other}, expected integers or real numbers up to 64 bits");
                return Err(Error::malformed(message).at("datatype"));
            }
        };
        let bits = self.i16(72);
        if bits != 8 * sample.len() as i16 {
            let message = format!("states {bits} bits per value, but their type has {}", 8 * sample.len());
            return Err(Error::malformed(message).at("bitpix"));
        }
        Ok(sample)
    }

    /// Offset of the values (`vox_offset`).
    fn data_start(&self) -> Result<u64> {
        let start = self.f32(108);
        // 2^24: f32 holds all integers up to here.
        if start.fract() != 0.0 || !(HEADER_LEN as f32 + 4.0..=16_777_216.0).contains(&start) {
            return Err(Error::malformed(format!("values cannot start at byte {start}")).at("vox_offset"));
        }
        Ok(start as u64)
    }

    /// Slope and intercept that convert stored numbers to values (`scl_slope`, `scl_inter`); a slope of 0
    /// means none.
    fn scaling(&self) -> Result<Option<[f64; 2]>> {
        let [slope, intercept] = [self.f32(112), self.f32(116)];
        if slope == 0.0 || slope.is_nan() || (slope, intercept) == (1.0, 0.0) {
            return Ok(None);
        }
        if !(slope.is_finite() && intercept.is_finite()) {
            let message = format!("values cannot be {slope} times what is stored plus {intercept}");
            return Err(Error::malformed(message).at("scl_slope"));
        }
        Ok(Some([slope.into(), intercept.into()]))
    }

    /// World coordinates of the sites by `sform`, else by `qform`, else by the distances alone.
    fn world(&self) -> std::result::Result<World, String> {
        let sizes = [0, 1, 2].map(|axis| self.distance(axis));
        let (origin, steps) = if self.i16(254) > 0 {
            self.affine()
        } else if self.i16(252) > 0 {
            self.rotation(sizes)
        } else {
            let [x, y, z] = sizes;
            ([0.0; 3], [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z]])
        };
        // Files of single volumes leave the time step at 0.
        let dt = match self.distance(3) {
            0.0 => 1.0,
            step => step,
        };
        World::new(origin, steps, Some(sizes.map(f64::abs)), [self.f32(136).into(), dt])
    }

    /// The units of lengths and times (`xyzt_units`). The last ones are of a fourth axis that is no time.
    fn units(&self) -> Option<String> {
        const LENGTHS: [&str; 4] = ["", "m", "mm", "micrometres"];
        const TIMES: [&str; 7] = ["", "s", "ms", "microseconds", "Hz", "ppm", "rad/s"];
        let stated = self.bytes[123];
        let of = |names: &[&str], code: u8| -> Vec<String> {
            names
                .get(usize::from(code))
                .filter(|name| !name.is_empty())
                .map(|name| name.to_string())
                .into_iter()
                .collect()
        };
        units_of(of(&LENGTHS, stated & 7), &of(&TIMES, stated >> 3 & 7))
    }

    /// Distance between sites along an axis (`pixdim`).
    fn distance(&self, axis: usize) -> f64 {
        self.f32(80 + 4 * axis).into()
    }

    /// Origin, and steps along each axis of the grid, by the affine map (`srow_x`, `srow_y`, `srow_z`).
    fn affine(&self) -> (Point, [Point; 3]) {
        let column = |column: usize| [0, 1, 2].map(|row| f64::from(self.f32(280 + 16 * row + 4 * column)));
        (column(3), [column(0), column(1), column(2)])
    }

    /// The same by the rotation that the unit quaternion of `quatern_b`, `quatern_c` and `quatern_d` states;
    /// its first component follows from these.
    fn rotation(&self, sizes: [f64; 3]) -> (Point, [Point; 3]) {
        let [b, c, d] = [256, 260, 264].map(|at| f64::from(self.f32(at)));
        let rest = 1.0 - (b * b + c * c + d * d);
        // Within rounding this is a half turn.
        let (a, scale) = if rest < 1e-7 { (0.0, 1.0 / (1.0 - rest).sqrt()) } else { (rest.sqrt(), 1.0) };
        let [b, c, d] = [b, c, d].map(|part| part * scale);
        let axes = [
            [a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)],
            [2.0 * (b * c - a * d), a * a + c * c - b * b - d * d, 2.0 * (c * d + a * b)],
            [2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a + d * d - c * c - b * b],
        ];
        // qfac (pixdim[0]) below 0 mirrors the third axis.
        let mirror = if self.f32(76) < 0.0 { -1.0 } else { 1.0 };
        let [x, y, z] = sizes;
        let steps = [(axes[0], x), (axes[1], y), (axes[2], z * mirror)];
        let steps = steps.map(|(axis, size)| axis.map(|part| whole(part) * size));
        ([268, 272, 276].map(|at| f64::from(self.f32(at))), steps)
    }
}

/// A component of a unit vector; 1, 0 or -1 if it is that within the rounding of f32.
fn whole(part: f64) -> f64 {
    if (part - part.round()).abs() < 1e-6 { part.round() } else { part }
}
