//! `spfinalize --levels`: the levels of lakes and rivers as a layer.

use std::path::Path;

use super::{Flags, TOOL, Watch};
use spmesh_base::error::counted;
use spmesh_base::output::Output;
use spmesh_shell::{endings, notice, say};

/// Most notices about lakes that are printed.
const NOTICES_MAX: usize = 20;

/// Writes the layer.
pub(super) fn write(flags: &Flags, path: &Path) -> anyhow::Result<()> {
    endings::check(path, &[&["geojson", "json"]])?;
    let mut recipe = flags.recipe()?;
    recipe.inputs = flags.paths()?;
    let mut output = Output::create(path, true)?;
    let mut watch = Watch { common: &flags.common, progress: None };
    let shores = recipe.write_levels(&mut watch, &mut output)?;
    drop(watch);
    let notices = flags.water.check_levels(&shores)?;
    notices.iter().take(NOTICES_MAX).for_each(|message| notice(TOOL, &flags.common, message));
    if notices.len() > NOTICES_MAX {
        let more = counted((notices.len() - NOTICES_MAX) as u64, "more lake", "more lakes");
        notice(TOOL, &flags.common, &format!("{more} like these"));
    }
    output.commit()?;
    if !flags.common.quiet && path != Path::new("-") {
        let rivers = shores.iter().filter(|shore| shore.river.is_some()).count();
        let below: usize = shores.iter().map(|shore| shore.below).sum();
        let stated = shores.iter().filter(|shore| shore.is_stated()).count();
        say(&format!(
            "lakes                {}\nparts of rivers      {rivers}\nlevels stated        {stated}\nlevels from points   \
             {}\npoints near shores below the water  {below}\n",
            shores.len() - rivers,
            shores.len() - stated
        ));
    }
    Ok(())
}
