//! How many points may be selected.

use crate::volumes::scan::Supply;
use crate::volumes::too_many;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_base::limits::{DIAGRAM4_POINT_BYTES, POINTS4_MAX};
use spmesh_base::system::memory_limit;

/// Advice for too many points.
pub(crate) const REMEDY: &str = "choose some of them with --where, --sample or --count";

/// The most points of an input that may be selected: [`POINTS4_MAX`], and as many as the memory of this
/// process can hold the diagram of.
pub(crate) struct Budget {
    most: u64,
    /// Memory of this process in bytes, if it is the limit.
    memory: Option<u64>,
}

impl Budget {
    /// The budget for an input, whose diagram must fit memory if it is to be there as a whole. Lines and
    /// streams may repeat points, and diagrams hold each only once, so that the memory for their diagram is
    /// not known before it is made.
    pub(crate) fn of(supply: &Supply, in_memory: bool) -> Budget {
        let are_distinct = matches!(supply, Supply::Grid(_) | Supply::Volume(_));
        Budget::within(memory_limit().filter(|_| are_distinct && in_memory))
    }

    fn within(memory: Option<u64>) -> Budget {
        let most = memory.map_or(u64::MAX, |bytes| bytes / DIAGRAM4_POINT_BYTES);
        Budget { most: most.min(POINTS4_MAX), memory: memory.filter(|_| most < POINTS4_MAX) }
    }

    /// Whether so many points are too many.
    pub(crate) fn is_exceeded_by(&self, points: u64) -> bool {
        points > self.most
    }

    /// Refuses more points than the budget has.
    pub(crate) fn check(&self, points: u64) -> Result<()> {
        if points <= self.most {
            return Ok(());
        }
        match self.memory.filter(|_| points <= POINTS4_MAX) {
            Some(memory) => {
                let needed = points * DIAGRAM4_POINT_BYTES;
                let [needed, memory] = [needed, memory].map(|bytes| bytes.div_ceil(1 << 20));
                let message = format!(
                    "not enough memory: the diagram of {points} points takes at least {needed} MiB, there are \
                     {memory}: {REMEDY}"
                );
                Err(Error::new(ErrorKind::Memory, message))
            }
            None => Err(too_many("points", points, POINTS4_MAX, REMEDY)),
        }
    }

    /// The same for a part of some points, if there are at least `points`.
    pub(crate) fn check_part(&self, points: u64, part: f64) -> Result<()> {
        self.check((part * points as f64) as u64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smaller_limit_decides() {
        let wide = Budget::within(None);
        assert!(wide.check(POINTS4_MAX).is_ok() && !wide.is_exceeded_by(POINTS4_MAX));
        assert_eq!(wide.check(POINTS4_MAX + 1).unwrap_err().kind(), ErrorKind::Usage);
        let narrow = Budget::within(Some(1000 * DIAGRAM4_POINT_BYTES));
        assert!(narrow.check(1000).is_ok() && narrow.check_part(2001, 0.5).is_ok());
        for refused in [narrow.check(1001), narrow.check_part(2002, 0.5)] {
            assert_eq!(refused.unwrap_err().kind(), ErrorKind::Memory);
        }
        assert_eq!(narrow.check(POINTS4_MAX + 1).unwrap_err().kind(), ErrorKind::Usage);
    }
}
