//! NIfTI-1: a header of 348 bytes, then the values (nifti1.h of the NIfTI Data Format Working Group, 2007).
//!
//! The `nifti` crate would add arrays and linear algebra as dependencies; a dozen fields are all that is
//! needed here.

use super::data::{Data, Encoding, Part, Skip};
use super::lattice::{Frame, Lattice};
use super::volume::Volume;
use crate::source::byte_order::ByteOrder;
use crate::source::origin::Origin;
use crate::source::sample_type::SampleType;
use spmesh_core::error::{Error, Result};

/// Length of the header, which its first four bytes state.
const HEADER_LEN: u32 = 348;

/// Length of a NIfTI-2 header.
const HEADER2_LEN: u32 = 540;

/// Offset of the magic bytes.
const MAGIC_AT: usize = 344;

/// Reads the header of a volume.
///
/// # Errors
/// If it is not a single file of real numbers in three or four dimensions, or its fields make no sense.
pub(super) fn open(origin: Origin, head: &[u8], is_gzip: bool, warnings: &mut Vec<String>) -> Result<Volume> {
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
    fn world(&self) -> std::result::Result<Frame, String> {
        let (mins, steps) = if self.i16(254) > 0 {
            self.affine()?
        } else if self.i16(252) > 0 {
            self.rotation()?
        } else {
            ([0.0; 3], [0, 1, 2].map(|axis| self.distance(axis)))
        };
        let [x, y, z] = mins;
        let [dx, dy, dz] = steps;
        let mins = [x, y, z, f64::from(self.f32(136))];
        // Files of single volumes leave the time step at 0.
        let dt = match self.distance(3) {
            0.0 => 1.0,
            step => step,
        };
        let steps = [dx, dy, dz, dt];
        let is_good = mins.iter().all(|min| min.is_finite());
        if !is_good || !steps.iter().all(|step| step.is_finite() && *step != 0.0) {
            return Err(format!("sites cannot be {steps:?} apart, starting at {mins:?}"));
        }
        Ok(Frame { mins, steps })
    }

    /// Distance between sites along an axis (`pixdim`).
    fn distance(&self, axis: usize) -> f64 {
        self.f32(80 + 4 * axis).into()
    }

    /// Origin and steps of the affine map (`srow_x`, `srow_y`, `srow_z`).
    fn affine(&self) -> std::result::Result<([f64; 3], [f64; 3]), String> {
        let entry = |row: usize, column: usize| f64::from(self.f32(280 + 16 * row + 4 * column));
        if (0..3).any(|row| (0..3).any(|column| row != column && entry(row, column) != 0.0)) {
            return Err(oblique());
        }
        Ok(([0, 1, 2].map(|row| entry(row, 3)), [0, 1, 2].map(|row| entry(row, row))))
    }

    /// Origin and steps of the rotation that `quatern_b` and its siblings state, if it maps axes to
    /// themselves.
    fn rotation(&self) -> std::result::Result<([f64; 3], [f64; 3]), String> {
        let turn = [256, 260, 264].map(|at| self.f32(at));
        // A half turn around an axis has one component of 1; the identity has only zeros.
        let signs = match turn.map(f32::abs) {
            [0.0, 0.0, 0.0] => [1.0, 1.0, 1.0],
            [1.0, 0.0, 0.0] => [1.0, -1.0, -1.0],
            [0.0, 1.0, 0.0] => [-1.0, 1.0, -1.0],
            [0.0, 0.0, 1.0] => [-1.0, -1.0, 1.0],
            _ => return Err(oblique()),
        };
        // qfac (pixdim[0]) below 0 mirrors the third axis.
        let mirror = if self.f32(76) < 0.0 { -1.0 } else { 1.0 };
        let mut steps = [0, 1, 2].map(|axis| signs[axis] * self.distance(axis));
        steps[2] *= mirror;
        Ok(([268, 272, 276].map(|at| f64::from(self.f32(at))), steps))
    }
}

fn oblique() -> String {
    "the grid does not lie along the axes of the world".to_string()
}
