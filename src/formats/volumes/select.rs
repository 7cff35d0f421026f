//! Selects the points of an input.

use crate::volumes::budget::Budget;
use crate::volumes::orientation::Orientation;
use crate::volumes::sample::choose;
use crate::volumes::scan::Supply;
use crate::volumes::{Selected4, Selection, Share};
use spmesh_base::allocator::may_fail;
use spmesh_base::error::{Error, ErrorKind, Result};
use spmesh_stream::model::cells4::Point4;
use std::collections::TryReserveError;

/// The selected points, in the order of the input; `orientation` is that of an oblique grid.
///
/// Cost: a pass over the input. It takes a pass more if points are chosen at random, or if there may be more
/// points than the budget allows: that pass keeps no points, and ends at the first one beyond the budget.
///
/// # Errors
/// As [`Supply::scan`]; usage, if the selection does not suit the input or selects too many points; memory,
/// if their diagram does not fit.
pub(crate) fn select(
    supply: &Supply,
    selection: &Selection,
    orientation: Option<&Orientation>,
    budget: Budget,
) -> Result<Selected4> {
    check(supply, selection)?;
    let selector = Selector { selection, orientation, budget };
    if let Some(points) = count_before(supply, selection)? {
        selector.budget.check(points)?;
    }
    match (supply, selection.share) {
        (Supply::Grid(lattice), Some(share)) if selection.condition.is_none() => {
            let sites = lattice.sites();
            let chosen = choose(sites, share.of(sites)?, selection.seed)?;
            let points = chosen.into_iter().map(|number| lattice.site(number)).collect();
            Ok(Selected4 { points, sites, ..Selected4::default() })
        }
        (_, Some(share)) => selector.at_random(supply, share),
        (_, None) => {
            if sites(supply).is_some_and(|sites| selector.budget.is_exceeded_by(sites)) {
                selector.count(supply, 1.0)?;
            }
            Ok(selector.intake(supply, |_| true)?.finish(selection))
        }
    }
}

fn check(supply: &Supply, selection: &Selection) -> Result<()> {
    if supply.has_values() {
        return Ok(());
    }
    if selection.condition.as_ref().is_some_and(|condition| condition.needs_value()) {
        return Err(Error::usage("points have no values here: --where can only compare x, y, z and t"));
    }
    Ok(())
}

/// The number of sites of a grid or a volume.
fn sites(supply: &Supply) -> Option<u64> {
    match supply {
        Supply::Grid(lattice) => Some(lattice.sites()),
        Supply::Volume(volume) => Some(volume.lattice.sites()),
        Supply::Text(_) | Supply::Stream(_) => None,
    }
}

/// The number of points that will be selected, if it is known before any is read or generated.
fn count_before(supply: &Supply, selection: &Selection) -> Result<Option<u64>> {
    let is_each_wanted = match supply {
        Supply::Volume(volume) => selection.keep_nan || volume.data.sample.is_integer(),
        _ => true,
    };
    let wanted = sites(supply).filter(|_| is_each_wanted && selection.condition.is_none());
    match (selection.share, wanted) {
        (Some(share), Some(wanted)) => share.of(wanted).map(Some),
        (Some(Share::Count(count)), None) => Ok(Some(count)),
        (Some(Share::Part(_)), None) => Ok(None),
        (None, wanted) => Ok(wanted),
    }
}

/// Tells which points are wanted, and how many may be selected.
struct Selector<'s> {
    selection: &'s Selection,
    orientation: Option<&'s Orientation>,
    budget: Budget,
}

impl Selector<'_> {
    fn wants(&self, point: &Point4, value: Option<f64>) -> bool {
        let Selector { selection, orientation, .. } = self;
        let holds = |condition: &crate::volumes::Condition| {
            let place = orientation.map_or(*point, |orientation| orientation.point_to_world(*point));
            condition.holds(&place, value.unwrap_or(f64::NAN))
        };
        (selection.keep_nan || !value.is_some_and(f64::is_nan))
            && selection.condition.as_ref().is_none_or(holds)
    }

    /// The number of wanted points, of which a part will be selected.
    fn count(&self, supply: &Supply, part: f64) -> Result<u64> {
        let mut wanted = 0;
        supply.scan(&mut |point, value| {
            if self.wants(&point, value) {
                wanted += 1;
                self.budget.check_part(wanted, part)?;
            }
            Ok(())
        })?;
        Ok(wanted)
    }

    /// Takes two passes: the number of wanted points must be known before some of them are chosen.
    fn at_random(&self, supply: &Supply, share: Share) -> Result<Selected4> {
        let wanted = match share {
            Share::Part(part) => self.count(supply, part)?,
            Share::Count(_) => self.count(supply, 0.0)?,
        };
        let mut chosen = choose(wanted, share.of(wanted)?, self.selection.seed)?.into_iter().peekable();
        let intake = self.intake(supply, |number| chosen.next_if_eq(&number).is_some())?;
        if chosen.peek().is_some() || intake.wanted != wanted {
            // Only another process can have changed the input.
            return Err(Error::malformed("has changed while it was read: read it again"));
        }
        Ok(intake.finish(self.selection))
    }

    /// Collects those wanted points for whose index among the wanted points `keeps` returns true.
    fn intake(&self, supply: &Supply, mut keeps: impl FnMut(u64) -> bool) -> Result<Intake> {
        let values = supply.has_values().then(Vec::new);
        let mut intake = Intake { values, ..Intake::default() };
        let warning = supply.scan(&mut |point, value| {
            intake.sites += 1;
            intake.missing += u64::from(value.is_some_and(f64::is_nan));
            if !self.wants(&point, value) {
                return Ok(());
            }
            intake.wanted += 1;
            if !keeps(intake.wanted - 1) {
                return Ok(());
            }
            self.budget.check(intake.points.len() as u64 + 1)?;
            intake.push(point, value)
        })?;
        Ok(Intake { warning, ..intake })
    }
}

/// Collects points.
#[derive(Default)]
struct Intake {
    points: Vec<Point4>,
    values: Option<Vec<f64>>,
    sites: u64,
    wanted: u64,
    missing: u64,
    warning: Option<String>,
}

/// Makes room for one more item. Few calls have to ask for memory.
fn make_room<T>(items: &mut Vec<T>) -> std::result::Result<(), TryReserveError> {
    if items.len() < items.capacity() { Ok(()) } else { may_fail(|| items.try_reserve(1)) }
}

impl Intake {
    fn push(&mut self, point: Point4, value: Option<f64>) -> Result<()> {
        let count = self.points.len();
        let no_memory = |_| Error::new(ErrorKind::Memory, format!("not enough memory for {count} points"));
        make_room(&mut self.points).map_err(no_memory)?;
        self.points.push(point);
        if let (Some(values), Some(value)) = (&mut self.values, value) {
            make_room(values).map_err(no_memory)?;
            values.push(value);
        }
        Ok(())
    }

    fn finish(self, selection: &Selection) -> Selected4 {
        let Intake { points, values, sites, wanted, missing, warning } = self;
        let mut warnings = Vec::from_iter(warning);
        if missing > 0 && !selection.keep_nan {
            warnings.push(format!("{missing} of {sites} points have no value (NaN) and are left out"));
        }
        if points.is_empty() {
            let why = if wanted == 0 { "none fulfils what is asked for" } else { "too few are chosen" };
            warnings.push(format!("no point is left of {sites}: {why}"));
        }
        Selected4 { points, values, sites, warnings, ..Selected4::default() }
    }
}
