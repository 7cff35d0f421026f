//! The filters of LAS records, applied to their bytes.
//!
//! Source: LAS specification 1.4 R15, point data record formats 0 to 10.

use laz::DecompressionSelection;

use crate::source::filters::{DropReason, Filters, Interval, NOISE};

/// Place of the class in formats 0 to 5, and of the flags in all formats.
const FLAGS: usize = 15;

/// The class of points in the overlap of swaths, in formats 0 to 5.
const OVERLAP_CLASS: u8 = 12;

/// A field of numbers, and those that are wanted.
#[derive(Debug, Clone)]
struct Range {
    reason: DropReason,
    at: usize,
    len: usize,
    wanted: Interval,
}

impl Range {
    fn contains(&self, record: &[u8]) -> bool {
        let bytes = &record[self.at..self.at + self.len];
        let value = match *bytes {
            [byte] => f64::from(byte),
            [low, high] => f64::from(u16::from_le_bytes([low, high])),
            _ => f64::from_le_bytes(bytes.try_into().expect("eight bytes")),
        };
        self.wanted.contains(value)
    }
}

/// Which records of a format to keep.
#[derive(Debug, Clone)]
pub(crate) struct RecordFilter {
    is_extended: bool,
    /// Bits of the flags' byte that drop a point. Each is 0 if it does not count.
    withheld: u8,
    synthetic: u8,
    overlap: u8,
    /// Bit that a point must have; 0 if it need not.
    keypoint: u8,
    drop_overlap_class: bool,
    keep: [bool; 256],
    first_only: bool,
    last_only: bool,
    keep_return: Vec<u8>,
    ranges: Vec<Range>,
    /// Whether only withheld points are dropped.
    keeps_others: bool,
}

/// Bit of each flag. Formats 0 to 5 have three flags above 5 bits of class.
fn bit(is_counted: bool, is_extended: bool, number: u8) -> u8 {
    if is_counted { 1 << if is_extended { number } else { number + 5 } } else { 0 }
}

impl RecordFilter {
    pub(crate) fn new(filters: &Filters, format: u8) -> Self {
        let is_extended = format >= 6;
        let mut keep = [filters.keep_class.is_empty(); 256];
        filters.keep_class.iter().for_each(|&class| keep[usize::from(class)] = true);
        let noise = NOISE.iter().filter(|_| filters.drop_noise);
        filters.drop_class.iter().chain(noise).for_each(|&class| keep[usize::from(class)] = false);
        RecordFilter {
            is_extended,
            withheld: bit(!filters.keep_withheld, is_extended, 2),
            synthetic: bit(filters.drop_synthetic, is_extended, 0),
            overlap: bit(filters.drop_overlap && is_extended, true, 3),
            keypoint: bit(filters.keep_keypoint, is_extended, 1),
            drop_overlap_class: filters.drop_overlap && !is_extended,
            keep,
            first_only: filters.first_only,
            last_only: filters.last_only,
            keep_return: filters.keep_return.clone(),
            ranges: ranges(filters, is_extended),
            keeps_others: filters.needs().is_none() && !filters.drop_noise,
        }
    }

    /// Whether the filter keeps every record that is not withheld.
    pub(crate) fn keeps_others(&self) -> bool {
        self.keeps_others
    }

    /// The byte that tells, together with those of other records, whether [`RecordFilter::is_withheld`].
    pub(crate) fn flags(record: &[u8]) -> u8 {
        record[FLAGS]
    }

    /// Whether one of the records is withheld, by the bits that their flags have in all.
    pub(crate) fn is_withheld(&self, flags: u8) -> bool {
        flags & self.withheld != 0
    }

    /// Why to drop `record`; `None` to keep it. Formats 0 to 5 have 5 bits for the class and 3 for each return
    /// number, formats 6 to 10 have 8 and 4. A return number of 0 means none: it counts as both first and last.
    pub(crate) fn reason(&self, record: &[u8]) -> Option<DropReason> {
        let (flags, returns) = (record[FLAGS], record[14]);
        let (class, number, of) = if self.is_extended {
            (record[16], returns & 15, returns >> 4)
        } else {
            (flags & 31, returns & 7, (returns >> 3) & 7)
        };
        let is_overlap = flags & self.overlap != 0 || self.drop_overlap_class && class == OVERLAP_CLASS;
        let is_return_wanted = (!self.first_only || number <= 1)
            && (!self.last_only || number == 0 || number >= of)
            && (self.keep_return.is_empty() || self.keep_return.contains(&number));
        let tests = [
            (self.is_withheld(flags), DropReason::Withheld),
            (flags & self.synthetic != 0, DropReason::Synthetic),
            (is_overlap, DropReason::Overlap),
            (flags & self.keypoint != self.keypoint, DropReason::Keypoint),
            (!self.keep[usize::from(class)], DropReason::Class),
            (!is_return_wanted, DropReason::Return),
        ];
        let first = tests.into_iter().find(|(is_dropped, _)| *is_dropped).map(|(_, reason)| reason);
        first.or_else(|| self.ranges.iter().find(|range| !range.contains(record)).map(|range| range.reason))
    }

    /// The fields to decompress: coordinates, class, return numbers, and what the filters look at. Class and
    /// return numbers cost little, as they share layers with other fields or are short.
    pub(crate) fn selection(&self) -> DecompressionSelection {
        let places = DecompressionSelection::xy_returns_channel().decompress_z().decompress_classification();
        let counts_flags = self.withheld | self.synthetic | self.overlap | self.keypoint != 0;
        let start = if counts_flags { places.decompress_flags() } else { places };
        self.ranges.iter().fold(start, |selection, range| match range.reason {
            DropReason::Intensity => selection.decompress_intensity(),
            DropReason::UserData => selection.decompress_user_data(),
            DropReason::PointSource => selection.decompress_point_source_id(),
            _ => selection.decompress_gps_time(),
        })
    }
}

fn ranges(filters: &Filters, is_extended: bool) -> Vec<Range> {
    let (source, time) = if is_extended { (20, 22) } else { (18, 20) };
    let ranges = [
        (DropReason::Intensity, 12, 2, filters.intensity),
        (DropReason::UserData, 17, 1, filters.user_data),
        (DropReason::PointSource, source, 2, filters.point_source),
        (DropReason::GpsTime, time, 8, filters.gps_time),
    ];
    let range = |(reason, at, len, wanted): (_, _, _, Option<Interval>)| {
        wanted.map(|wanted| Range { reason, at, len, wanted })
    };
    ranges.into_iter().filter_map(range).collect()
}
