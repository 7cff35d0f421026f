//! `spfinalize --levels`: the levels of lakes and rivers as a layer.

use std::path::Path;

use super::{Flags, Watch};
use spmesh_base::output::Output;
use spmesh_shell::{endings, say};

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
    flags.notice_some(&notices);
    output.commit()?;
    if !flags.common.quiet && path != Path::new("-") {
        let rivers = shores.iter().filter(|shore| shore.river.is_some()).count();
        let below: usize = shores.iter().map(|shore| shore.below).sum();
        let stated = shores.iter().filter(|shore| shore.is_stated).count();
        say(&format!(
            "lakes                   {}\nparts of rivers         {rivers}\nlevels stated           {stated}\n\
             levels from points      {}\nshore points below      {below}\n",
            shores.len() - rivers,
            shores.len() - stated
        ));
    }
    Ok(())
}
