//! Flags that say how a GeoTIFF is written.

use clap::Args;

use super::{Names, named};
use spmesh_base::error::{Error, Result};
use spmesh_formats::raster::{CellType, Compression, Date, Integers, NoData, Predictor, Storage};

/// Flags for the numbers and the tags of a GeoTIFF.
#[derive(Debug, Clone, Args)]
pub(super) struct GeoTiffFlags {
    /// The type of numbers in a GeoTIFF. Values are rounded to integers; one that does not fit is an error
    /// [default: float32]
    #[arg(long, value_name = "TYPE", value_parser = named(TYPES))]
    r#type: Option<CellType>,

    /// What an integer of --type is multiplied by to get the value [default: 1]
    #[arg(long, value_name = "NUMBER", requires = "type", allow_negative_numbers = true)]
    scale: Option<f64>,

    /// What is added to an integer, times the scale, to get the value [default: 0]
    #[arg(long, value_name = "NUMBER", requires = "type", allow_negative_numbers = true)]
    offset: Option<f64>,

    /// How a GeoTIFF is compressed [default: deflate]
    #[arg(long, value_name = "METHOD", value_parser = named(COMPRESSIONS))]
    compression: Option<Compression>,

    /// What is compressed: numbers, their differences, or differences of bytes of equal significance
    /// [default: float for float32, otherwise horizontal]
    #[arg(long, value_name = "WHAT", value_parser = named(PREDICTORS))]
    predictor: Option<Predictor>,

    /// State least and greatest number, mean and standard deviation in a GeoTIFF, as GDAL reads them
    #[arg(long)]
    statistics: bool,

    /// The day of the data, or a second in UTC such as 2021-06-15T12:30:00Z: the tag DateTime of a GeoTIFF,
    /// and the date of STAC items [default: none]
    #[arg(long, value_name = "DATE")]
    date: Option<Date>,
}

const TYPES: Names<CellType> = &[
    ("float32", CellType::Float32),
    ("byte", CellType::Byte),
    ("int16", CellType::Int16),
    ("int32", CellType::Int32),
];

const COMPRESSIONS: Names<Compression> =
    &[("deflate", Compression::Deflate), ("zstd", Compression::Zstd), ("none", Compression::None)];

const PREDICTORS: Names<Predictor> =
    &[("none", Predictor::None), ("horizontal", Predictor::Horizontal), ("float", Predictor::Float)];

impl GeoTiffFlags {
    /// The number of cells without data, and how numbers are stored.
    pub(super) fn storage(&self, no_data: Option<f64>) -> Result<(NoData, Storage)> {
        let transform = [self.scale.unwrap_or(1.0), self.offset.unwrap_or(0.0)];
        let (of_floats, integers) = match self.r#type.unwrap_or_default() {
            CellType::Float32 if [1.0, 0.0] != transform => {
                return Err(Error::usage(
                    "--scale and --offset are for integers: give --type int16 or int32",
                ));
            }
            CellType::Float32 => (no_data, None),
            integers => (None, Some(Integers::new(integers, transform, no_data)?)),
        };
        let of_floats = of_floats.map(|no_data| no_data as f32);
        if of_floats.is_some_and(f32::is_infinite) {
            return Err(Error::usage("--no-data takes a finite number of 32 bits, or nan"));
        }
        let storage = Storage {
            integers,
            compression: self.compression.unwrap_or_default(),
            predictor: self.predictor,
        };
        storage.check()?;
        Ok((of_floats.map(NoData).unwrap_or_default(), storage))
    }

    pub(super) fn has_statistics(&self) -> bool {
        self.statistics
    }

    pub(super) fn date(&self) -> Option<Date> {
        self.date
    }

    /// Refuses what pictures cannot have.
    pub(super) fn check_bytes(&self) -> Result<()> {
        if self.r#type.is_some_and(|stored| stored != CellType::Byte)
            || self.scale.is_some()
            || self.offset.is_some()
        {
            return Err(Error::usage("pictures are bytes: leave out --type, --scale and --offset"));
        }
        if self.predictor == Some(Predictor::Float) {
            return Err(Error::usage("--predictor float is for numbers of --type float32: take horizontal"));
        }
        if self.statistics {
            return Err(Error::usage("--statistics are those of values: leave it out for a picture"));
        }
        Ok(())
    }

    /// Refuses flags where no GeoTIFF is written.
    pub(super) fn check_unused(&self) -> Result<()> {
        let is_used = [
            self.r#type.is_some(),
            self.compression.is_some(),
            self.predictor.is_some(),
            self.statistics,
            self.date.is_some(),
        ];
        if is_used.contains(&true) {
            return Err(Error::usage(
                "--type, --compression, --predictor, --statistics and --date are for GeoTIFF: take an output that ends in .tif",
            ));
        }
        Ok(())
    }
}
