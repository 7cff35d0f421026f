//! All parts as one mesh.

use std::io::Write;
use std::path::{Path, PathBuf};

use super::folder::Folder;
use super::make::options_text;
use super::{Maker, NodeReport, Plan, Work};
use crate::finalize::Recipe;
use crate::reduce::Duplicates;
use spmesh_base::error::{Error, ErrorKind, Result, counted};
use spmesh_base::output::Output;
use spmesh_formats::source::{Manifest, ManifestPart};

/// Checks all parts, makes missing ones with the policy for duplicates of those that are there, and writes
/// the manifest of the mesh into the file `manifest`. With `is_verified`, all parts are read, and those made
/// again whose checksums are wrong. `recipe` and `note` are as in [`Maker::new`].
///
/// # Errors
/// Those of [`Maker::run`]; usage, if nodes were made differently, or the manifest would replace the report
/// of one; malformed, if points are not accounted for.
pub fn collect(
    plan: &Plan,
    work: &Work,
    manifest: &Path,
    is_verified: bool,
    recipe: &dyn Fn(&Plan) -> Result<Recipe>,
    note: &dyn Fn(&str),
) -> Result<()> {
    check_name(manifest, &work.folder)?;
    let work = Work { duplicates: duplicates_of(plan, work)?, ..work.clone() };
    let maker = Maker::new(plan, &work, recipe, note)?;
    plan.note_files()?;
    let mut output = Output::create(manifest, false)?;
    let order = plan.upwards();
    for &number in &order {
        let node = plan.node(number)?;
        match maker.folder.with_mesh(number)? {
            None => {
                note(&format!("node {number} is not complete: making it"));
                maker.make(node)?;
            }
            Some(report) if report.joined != maker.folder.residual_hashes(node)? => {
                note(&format!("node {number} is older than what it joins: making it again"));
                maker.make(node)?;
            }
            Some(_) => {}
        }
        if is_verified && let Some(damage) = maker.folder.damage_of(node)? {
            note(&format!("{damage}: making node {number} again"));
            maker.make(node)?;
        }
    }
    let mut reports = Vec::with_capacity(order.len());
    for &number in &order {
        let gone = || Error::new(ErrorKind::Io, format!("node {number} is not complete any more"));
        reports.push(maker.folder.with_mesh(number)?.ok_or_else(gone)?);
    }
    if let Some(other) = reports.iter().find(|report| report.options != reports[0].options) {
        let (a, b) = (&reports[0], other);
        let message = format!(
            "node {} was made with {}, node {} with {}: make all nodes with the same flags",
            a.node, a.options, b.node, b.options
        );
        return Err(Error::usage(message));
    }
    check_sums(plan, &reports)?;
    let manifest = manifest_of(plan, &reports, &work.folder, manifest)?;
    output.write_all(manifest.to_json()?.as_bytes()).map_err(|e| Error::io("writing the manifest", e))?;
    output.commit()?;
    let simplices: u64 = reports.iter().map(|report| report.simplices).sum();
    let dropped: u64 = reports.iter().map(|report| report.dropped).sum();
    let (points, parts) = (plan.points, reports.len());
    let (parts, simplices) =
        (counted(parts as u64, "part", "parts"), counted(simplices, "simplex", "simplices"));
    let points = counted(points, "point", "points");
    note(&format!(
        "{parts}, {simplices}; {points}, all accounted for ({dropped} dropped, {} merged)",
        manifest.merged
    ));
    Ok(())
}

/// Checks that every point that the files state was in the box of one leaf, and became a vertex, was merged,
/// or was dropped by a filter there.
fn check_sums(plan: &Plan, reports: &[NodeReport]) -> Result<()> {
    let mut found = vec![0u64; plan.files.len()];
    for count in reports.iter().flat_map(|report| &report.files) {
        if let Some(points) = found.get_mut(count.file as usize) {
            *points += count.points;
        }
    }
    if let Some((file, found)) = plan.files.iter().zip(&found).find(|(file, found)| file.points != **found) {
        let stated = file.points;
        let message = format!(
            "states {stated} points, but the leaves found {found} of it: its header or its index is wrong (make its \
             header or index anew, and plan again)"
        );
        return Err(Error::malformed(message).of_input(&file.path));
    }
    for report in reports.iter().filter(|report| report.stage == 0) {
        let counted: u64 = report.files.iter().map(|count| count.points).sum();
        if counted != report.points + report.dropped {
            return Err(Error::malformed(format!(
                "node {} found {counted} points, but triangulated {} and dropped {}",
                report.node, report.points, report.dropped
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
fn check_name(output: &Path, folder: &Path) -> Result<()> {
    let parent = output.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let both = std::fs::canonicalize(parent).ok().zip(std::fs::canonicalize(folder).ok());
    let stem = output.file_stem().and_then(|stem| stem.to_str()).unwrap_or_default();
    if both.is_some_and(|(parent, folder)| parent == folder) && stem.bytes().all(|byte| byte.is_ascii_digit())
    {
        let message = "the name is that of the report of a node: give another one";
        return Err(Error::usage(message).of_input(output.display().to_string()));
    }
    Ok(())
}

/// The policy that the nodes so far were made with.
fn duplicates_of(plan: &Plan, work: &Work) -> Result<Duplicates> {
    use Duplicates::{Error as Refused, First, Highest, Lowest, Mean};
    let folder = Folder { path: &work.folder, plan };
    for node in &plan.nodes {
        if let Some(NodeReport { options, .. }) = folder.report(node.number)? {
            let mut all = [First, Lowest, Highest, Mean, Refused].into_iter();
            let found = all.find(|&duplicates| options_text(duplicates) == options);
            return found
                .ok_or_else(|| Error::malformed(format!("options {options:?} of node {}", node.number)));
        }
    }
    Ok(First)
}

fn manifest_of(plan: &Plan, reports: &[NodeReport], folder: &Path, output: &Path) -> Result<Manifest> {
    let base = relative(folder, output)?;
    let file = |report: &NodeReport| -> Result<String> {
        let path = base.join(&report.mesh.file);
        path.to_str().map(str::to_string).ok_or_else(|| Error::usage("the folder of the parts is not UTF-8"))
    };
    let part = |report: &NodeReport| -> Result<ManifestPart> {
        Ok(ManifestPart {
            number: report.node,
            file: file(report)?,
            bytes: report.mesh.bytes,
            vertices: report.vertices,
            simplices: report.simplices,
        })
    };
    let parts = reports.iter().map(part).collect::<Result<Vec<_>>>()?;
    let mut manifest = Manifest::new(plan.id(), parts);
    let boxes = reports.iter().filter_map(|report| report.bounds);
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
