//! Flags that say which points to keep.

use std::num::NonZeroU32;

use clap::Args;

use crate::finalize::Thin;
use spmesh_formats::source::{Filters, Interval, Sample};
use spmesh_shell::parse_box;
use spmesh_stream::model::bounds::Bounds;

/// The filters, in the order in which they are applied.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Which points")]
pub struct PointFilters {
    /// Keep points that are marked as withheld, which are dropped otherwise: they count as deleted
    #[arg(long)]
    keep_withheld: bool,

    /// Drop points that are marked as synthetic
    #[arg(long)]
    drop_synthetic: bool,

    /// Drop points in the overlap of swaths: with the overlap flag, or of class 12 in point formats 0 to 5
    #[arg(long)]
    drop_overlap: bool,

    /// Keep only points that are marked as key points of the model
    #[arg(long)]
    keep_keypoint: bool,

    /// Keep only points of these classes
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    keep_class: Vec<u8>,

    /// Drop points of these classes
    #[arg(long, value_name = "CLASS", value_delimiter = ',')]
    drop_class: Vec<u8>,

    /// Keep only first returns
    #[arg(long)]
    first_only: bool,

    /// Keep only last returns
    #[arg(long)]
    last_only: bool,

    /// Keep only points with these return numbers
    #[arg(long, value_name = "N", value_delimiter = ',')]
    keep_return: Vec<u8>,

    /// Keep only points with an intensity from MIN to MAX; in this and the next filters, an end that is left
    /// out is open, as in 100,
    #[arg(long, value_name = "MIN,MAX", allow_hyphen_values = true)]
    keep_intensity: Option<Interval>,

    /// Keep only points with user data from MIN to MAX
    #[arg(long, value_name = "MIN,MAX", allow_hyphen_values = true)]
    keep_user_data: Option<Interval>,

    /// Keep only points with a point source ID from MIN to MAX: mostly the number of the flight line
    #[arg(long, value_name = "MIN,MAX", allow_hyphen_values = true)]
    keep_point_source: Option<Interval>,

    /// Keep only points with a GPS time from MIN to MAX
    #[arg(long, value_name = "MIN,MAX", allow_hyphen_values = true)]
    keep_gps_time: Option<Interval>,

    /// Keep only points that lie in this closed box: MINX,MINY,MINZ,MAXX,MAXY,MAXZ or, whatever their z,
    /// MINX,MINY,MAXX,MAXY
    #[arg(long, value_name = "BOX", value_parser = parse_box, allow_hyphen_values = true)]
    pub bounds: Option<Bounds>,

    /// Keep only points whose z is from MIN to MAX
    #[arg(long, value_name = "MIN,MAX", allow_hyphen_values = true)]
    keep_z: Option<Interval>,

    /// Keep one of N places, which a hash of x and y chooses whatever the order of the points: for check
    /// points
    #[arg(long, value_name = "N", conflicts_with = "drop_sample")]
    keep_sample: Option<NonZeroU32>,

    /// Drop the points that --keep-sample N keeps
    #[arg(long, value_name = "N")]
    drop_sample: Option<NonZeroU32>,

    /// Drop and count points with a coordinate that is not finite, instead of failing
    #[arg(long)]
    pub skip_invalid: bool,

    /// Of the points that the filters keep, keep one per square cell of side CELL (with --octree, per cube),
    /// by RULE: lowest, highest, first or nearest-centre; the first in input order of equal ones. Corners of
    /// cells are at multiples of CELL, in world units [default rule: lowest]
    #[arg(long, value_name = "CELL[:RULE]")]
    pub thin: Option<Thin>,
}

impl PointFilters {
    /// What the flags ask for.
    pub fn filters(&self) -> Filters {
        Filters {
            keep_withheld: self.keep_withheld,
            drop_synthetic: self.drop_synthetic,
            drop_overlap: self.drop_overlap,
            keep_keypoint: self.keep_keypoint,
            keep_class: self.keep_class.clone(),
            drop_class: self.drop_class.clone(),
            drop_noise: false,
            first_only: self.first_only,
            last_only: self.last_only,
            keep_return: self.keep_return.clone(),
            intensity: self.keep_intensity,
            user_data: self.keep_user_data,
            point_source: self.keep_point_source,
            gps_time: self.keep_gps_time,
            z: self.keep_z,
            sample: self.sample(),
        }
    }

    fn sample(&self) -> Option<Sample> {
        let sample = |one_in, is_complement| Sample { one_in, is_complement };
        let kept = self.keep_sample.map(|one_in| sample(one_in, false));
        kept.or(self.drop_sample.map(|one_in| sample(one_in, true)))
    }
}
