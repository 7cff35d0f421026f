//! How the numbers of cells are stored in a GeoTIFF.

use std::fmt;

use super::NoData;
use spmesh_base::error::{Error, Result};

/// Types of stored numbers.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum CellType {
    /// Floating-point numbers of 32 bits.
    #[default]
    Float32,
    /// Integers from 0 to 255.
    Byte,
    /// Signed integers of 16 bits.
    Int16,
    /// Signed integers of 32 bits.
    Int32,
}

impl CellType {
    /// The name that GDAL has for it.
    pub fn name(self) -> &'static str {
        match self {
            CellType::Float32 => "Float32",
            CellType::Byte => "Byte",
            CellType::Int16 => "Int16",
            CellType::Int32 => "Int32",
        }
    }

    /// Bytes of a number.
    pub(super) fn len(self) -> usize {
        match self {
            CellType::Byte => 1,
            CellType::Int16 => 2,
            CellType::Float32 | CellType::Int32 => 4,
        }
    }

    /// The least and the greatest integer.
    fn range(self) -> [f64; 2] {
        match self {
            CellType::Byte => [0.0, u8::MAX.into()],
            CellType::Int16 => [i16::MIN.into(), i16::MAX.into()],
            CellType::Float32 | CellType::Int32 => [i32::MIN.into(), i32::MAX.into()],
        }
    }
}

impl fmt::Display for CellType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name().to_ascii_lowercase())
    }
}

/// Integers that stand for values: a value is the integer times the scale, plus the offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integers {
    pub(super) cell_type: CellType,
    pub(super) scale: f64,
    pub(super) offset: f64,
    /// The integer of cells without data.
    pub(super) no_data: f64,
}

impl Integers {
    /// Integers of a type. Without a `no_data` number, it is the least of the type, or 255 of bytes, in which
    /// 0 is common.
    ///
    /// # Errors
    /// Usage, if the type is none of integers, the scale is not above zero, a number is not finite, or
    /// `no_data` is not one of the integers.
    pub fn new(cell_type: CellType, [scale, offset]: [f64; 2], no_data: Option<f64>) -> Result<Integers> {
        let [least, greatest] = cell_type.range();
        if cell_type == CellType::Float32 || !(scale > 0.0 && scale.is_finite() && offset.is_finite()) {
            return Err(Error::usage(format!(
                "integers with scale {scale} and offset {offset}: the scale must be above zero, and both finite"
            )));
        }
        let no_data = no_data.unwrap_or(if cell_type == CellType::Byte { greatest } else { least });
        if no_data.fract() != 0.0 || !(least..=greatest).contains(&no_data) {
            return Err(Error::usage(format!(
                "{no_data} for cells without data: {cell_type} holds integers from {least} to {greatest}"
            )));
        }
        Ok(Integers { cell_type, scale, offset, no_data })
    }

    /// The integer nearest to a value; NaN means no data.
    ///
    /// # Errors
    /// Usage, if there is none, or it is the one of cells without data.
    pub(super) fn stored(&self, value: f32) -> Result<f64> {
        if value.is_nan() {
            return Ok(self.no_data);
        }
        let number = ((f64::from(value) - self.offset) / self.scale).round() + 0.0;
        let [least, greatest] = self.cell_type.range();
        if number == self.no_data || !(least..=greatest).contains(&number) {
            return Err(self.does_not_fit(value, number));
        }
        Ok(number)
    }

    #[cold]
    fn does_not_fit(&self, value: f32, number: f64) -> Error {
        let Integers { cell_type, scale, offset, no_data } = self;
        let what = if number == *no_data {
            format!("becomes {number}, which stands for no data: give another --no-data, --scale or --offset")
        } else {
            let [least, greatest] = cell_type.range();
            format!(
                "becomes {number}, but {cell_type} holds {least} to {greatest}: give another --type, --scale or --offset"
            )
        };
        Error::usage(format!(
            "a cell has the value {value}, which with scale {scale} and offset {offset} {what}"
        ))
    }
}

/// How tiles are compressed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Compression {
    /// Deflate (zlib), which all programs read.
    #[default]
    Deflate,
    /// Zstandard, which GDAL and libtiff read.
    Zstd,
    /// None.
    None,
}

/// What is compressed instead of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Predictor {
    /// The numbers themselves.
    None,
    /// Differences to the number before (TIFF 6.0, section 14).
    Horizontal,
    /// Differences of bytes of equal significance (Adobe Photoshop TIFF technical note 3).
    Float,
}

/// How numbers become bytes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Storage {
    /// Integers that stand for values; otherwise values are floating-point numbers.
    pub integers: Option<Integers>,
    /// How bytes are compressed.
    pub compression: Compression,
    /// What is compressed; what compresses best if `None`.
    pub predictor: Option<Predictor>,
}

impl Storage {
    /// Refuses predictors that cannot be.
    ///
    /// # Errors
    /// Usage, if the predictor is not one of the type, or nothing is compressed.
    pub fn check(&self) -> Result<()> {
        match self.predictor {
            Some(Predictor::Float) if self.integers.is_some() => {
                Err(Error::usage("--predictor float is for numbers of --type float32: take horizontal"))
            }
            Some(Predictor::Float | Predictor::Horizontal) if self.compression == Compression::None => {
                Err(Error::usage("nothing is predicted without compression: leave out --predictor"))
            }
            _ => Ok(()),
        }
    }
}

/// The text of the number for cells without data.
pub(super) fn no_data_text(integers: Option<&Integers>, no_data: NoData) -> String {
    integers.map_or_else(|| no_data.to_string(), |integers| integers.no_data.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_rounded_and_never_cut() {
        let centimetres = Integers::new(CellType::Int16, [0.01, 300.0], None).unwrap();
        assert_eq!(centimetres.stored(312.345).unwrap(), 1235.0);
        assert_eq!(centimetres.stored(f32::NAN).unwrap(), -32768.0);
        for (value, part) in [
            (628.0, "becomes 32800, but int16 holds -32768 to 32767"),
            (-27.68, "stands for no data"),
            (f32::INFINITY, "becomes inf"),
        ] {
            let error = centimetres.stored(value).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
        let classes = Integers::new(CellType::Byte, [1.0, 0.0], None).unwrap();
        assert_eq!([0.0, 2.4, 254.0].map(|value| classes.stored(value).unwrap()), [0.0, 2.0, 254.0]);
        assert!(classes.stored(255.0).is_err() && classes.stored(-0.6).is_err());
        for (cell_type, transform, no_data) in [
            (CellType::Float32, [1.0, 0.0], None),
            (CellType::Int16, [0.0, 0.0], None),
            (CellType::Int16, [1.0, f64::NAN], None),
            (CellType::Int16, [1.0, 0.0], Some(f64::NAN)),
            (CellType::Byte, [1.0, 0.0], Some(-9999.0)),
            (CellType::Int32, [1.0, 0.0], Some(0.5)),
        ] {
            assert!(Integers::new(cell_type, transform, no_data).is_err(), "{cell_type} {no_data:?}");
        }
    }
}
