//! All parts as one mesh.

use std::collections::HashMap;
use std::ffi::OsStr;
use std::io::Write;
use std::path::{Path, PathBuf};

use super::{Again, Maker, NodeReport, Plan, Work};
use crate::finalize::Recipe;
use spmesh_base::error::{Error, ErrorKind, Result, counted};
use spmesh_base::output::Output;
use spmesh_formats::source::{Manifest, ManifestPart};
use spmesh_stream::PartName;

/// Makes all nodes that are not complete, and writes the manifest of the mesh into the file `manifest`. With
/// `is_verified`, all parts are read, and those made again whose checksums are wrong. `recipe` and `note` are
/// as in [`Maker::new`].
///
/// # Errors
/// Those of [`Maker::run`]; usage, if a file has changed since the plan was made, or the manifest would
/// replace the report of a node; malformed, if points are not accounted for.
pub fn collect(
    plan: &Plan,
    work: &Work,
    manifest: &Path,
    is_verified: bool,
    recipe: &dyn Fn(&Plan) -> Result<Recipe>,
    note: &dyn Fn(&str),
) -> Result<()> {
    check_name(manifest)?;
    plan.check_files()?;
    let maker = Maker::new(plan, work, recipe, note)?;
    plan.note_files()?;
    let mut output = Output::create(manifest, false)?;
    let order = plan.upwards();
    let again = if is_verified { Again::Damaged } else { Again::Incomplete };
    for &number in &order {
        maker.run(number, again)?;
    }
    let mut reports = Vec::with_capacity(order.len());
    for &number in &order {
        let gone = || Error::new(ErrorKind::Io, format!("node {number} is not complete any more"));
        reports.push(maker.folder.complete(plan.node(number)?)?.ok_or_else(gone)?);
    }
    check_sums(plan, &reports)?;
    let manifest = manifest_of(plan, &reports, &work.folder, manifest)?;
    output.write_all(manifest.to_json()?.as_bytes()).map_err(|e| Error::io("writing the manifest", e))?;
    output.commit()?;
    note(&summary(plan, &reports, &manifest));
    Ok(())
}

fn summary(plan: &Plan, reports: &[NodeReport], manifest: &Manifest) -> String {
    let simplices: u64 = reports.iter().map(|report| report.simplices).sum();
    let dropped: u64 = reports.iter().map(|report| report.dropped).sum();
    let skipped = match plan.skipped.len() as u64 {
        0 => String::new(),
        count => format!("; {} left out", counted(count, "bad file", "bad files")),
    };
    format!(
        "{}, {}; {}, all accounted for ({dropped} dropped, {} merged){skipped}",
        counted(reports.len() as u64, "part", "parts"),
        counted(simplices, "simplex", "simplices"),
        counted(plan.points, "point", "points"),
        manifest.merged
    )
}

/// Checks that every point that the files state was in the box of one leaf, and became a vertex, was merged,
/// or was dropped by a filter there.
fn check_sums(plan: &Plan, reports: &[NodeReport]) -> Result<()> {
    let mut found: HashMap<&str, u64> = HashMap::new();
    for count in reports.iter().flat_map(|report| &report.files) {
        *found.entry(&count.file).or_default() += count.points;
    }
    let found = plan.files.iter().map(|file| (file, found.get(file.name().as_str()).copied().unwrap_or(0)));
    if let Some((file, found)) = found.into_iter().find(|&(file, found)| file.points != found) {
        let stated = file.points;
        let message = format!(
            "states {stated} points, but the leaves found {found} of it: its header or its index is wrong (make its \
             header or index anew, and plan again)"
        );
        return Err(Error::malformed(message).of_input(file.name()));
    }
    for report in reports.iter().filter(|report| report.stage == 0) {
        let counted: u64 = report.files.iter().map(|count| count.points).sum();
        let added = report.added;
        if counted + added != report.points + report.dropped {
            return Err(Error::malformed(format!(
                "part {} found {counted} points and added {added}, but triangulated {} and dropped {}",
                report.name, report.points, report.dropped
            )));
        }
    }
    let sum = |count: fn(&NodeReport) -> u64| reports.iter().map(count).sum::<u64>();
    let [points, merged, vertices] = [sum(|it| it.points), sum(|it| it.merged), sum(|it| it.vertices)];
    if points != merged + vertices {
        return Err(Error::malformed(format!(
            "{points} points were triangulated, but {vertices} are vertices and {merged} were merged"
        )));
    }
    Ok(())
}

/// Refuses the names of reports, which the manifest would replace.
fn check_name(output: &Path) -> Result<()> {
    let text = |name: Option<&OsStr>| name.and_then(OsStr::to_str).unwrap_or_default().to_lowercase();
    let (name, folder) = (text(output.file_stem()), text(output.parent().and_then(Path::file_name)));
    if PartName::parse_node(&name).is_some() && folder.len() == 2 {
        let message = "the name is that of the report of a node: give another one";
        return Err(Error::usage(message).of_input(output.display().to_string()));
    }
    Ok(())
}

fn manifest_of(plan: &Plan, reports: &[NodeReport], folder: &Path, output: &Path) -> Result<Manifest> {
    let base = relative(folder, output)?;
    let file = |report: &NodeReport| -> Result<String> {
        let path = base.join(&report.name[..2]).join(&report.mesh.file);
        path.to_str().map(str::to_string).ok_or_else(|| Error::usage("the folder of the parts is not UTF-8"))
    };
    let part = |report: &NodeReport| -> Result<ManifestPart> {
        Ok(ManifestPart {
            name: report.name.clone(),
            below: report.below,
            file: file(report)?,
            bytes: report.mesh.bytes,
            vertices: report.vertices,
            simplices: report.simplices,
            bounds: report.bounds,
        })
    };
    let parts = reports.iter().map(part).collect::<Result<Vec<_>>>()?;
    let mut manifest = Manifest::new(parts);
    manifest.skipped.clone_from(&plan.skipped);
    let leaves = reports.iter().filter(|report| report.stage == 0);
    let boxes = leaves.filter_map(|report| report.bounds);
    manifest.bounds = boxes.reduce(|[a, b], [c, d]| {
        [std::array::from_fn(|i| a[i].min(c[i])), std::array::from_fn(|i| b[i].max(d[i]))]
    });
    manifest.points = reports.iter().map(|report| report.points).sum();
    manifest.merged = reports.iter().map(|report| report.merged).sum();
    Ok(manifest)
}

/// The folder of the parts as seen from the folder of the manifest: relative if it is inside of it, so that
/// both can be moved together.
fn relative(folder: &Path, manifest: &Path) -> Result<PathBuf> {
    let finding = |e| Error::io("finding the folder of the parts", e);
    let folder = std::fs::canonicalize(folder).map_err(finding)?;
    let home = manifest.parent().filter(|home| !home.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let home = std::fs::canonicalize(home).map_err(finding)?;
    Ok(folder.strip_prefix(&home).map_or(folder.clone(), Path::to_path_buf))
}
