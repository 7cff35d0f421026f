//! `spnode collect`: all parts as one mesh.

use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::make::Maker;
use super::{Policy, WorkFlags, tell};
use crate::plan::{NodeReport, Plan, check_sums};
use spmesh_base::error::{Error, Result};
use spmesh_base::output::Output;
use spmesh_base::places::check_apart;
use spmesh_formats::source::{Manifest, ManifestPart};
use spmesh_shell::{Common, endings};

#[derive(Debug, Args)]
pub(super) struct Flags {
    /// The plan of spfinalize --plan
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    /// File for the manifest, which stands for the mesh wherever a stream of it is read
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Read all parts, and make those again whose checksums are wrong
    #[arg(long)]
    verify: bool,

    #[command(flatten)]
    work: WorkFlags,
}

/// Checks all parts, makes missing ones, and writes the manifest.
pub(super) fn run(flags: &Flags, common: &Common) -> anyhow::Result<()> {
    endings::check(&flags.output, &[endings::JSON])?;
    let plan = Plan::read(&flags.plan)?;
    check_apart([flags.plan.as_path()], &[("--output", &flags.output)])?;
    check_name(&flags.output, &flags.work.dir)?;
    let policy = policy_of(&plan, &flags.work)?;
    let maker = Maker::new(&plan, &flags.work, policy, common)?;
    let mut output = Output::create(&flags.output, false)?;
    let order = plan.upwards();
    for &number in &order {
        let node = plan.node(number)?;
        match maker.folder.with_mesh(number)? {
            None => {
                maker.note(&format!("node {number} is not complete: making it"));
                maker.make(node)?;
            }
            Some(report) if report.joined != maker.folder.residual_hashes(node)? => {
                maker.note(&format!("node {number} is older than what it joins: making it again"));
                maker.make(node)?;
            }
            Some(_) => {}
        }
        if flags.verify
            && let Some(damage) = maker.folder.damage_of(node)?
        {
            maker.note(&format!("{damage}: making node {number} again"));
            maker.make(node)?;
        }
    }
    let mut reports = Vec::with_capacity(order.len());
    for &number in &order {
        let gone = || {
            Error::new(spmesh_base::error::ErrorKind::Io, format!("node {number} is not complete any more"))
        };
        reports.push(maker.folder.with_mesh(number)?.ok_or_else(gone)?);
    }
    if let Some(other) = reports.iter().find(|report| report.options != reports[0].options) {
        let (a, b) = (&reports[0], other);
        let message = format!(
            "node {} was made with {}, node {} with {}: make all nodes with the same flags",
            a.node, a.options, b.node, b.options
        );
        return Err(Error::usage(message).into());
    }
    check_sums(&plan, &reports)?;
    let manifest = manifest_of(&plan, &reports, &flags.work.dir, &flags.output)?;
    output.write_all(manifest.to_json()?.as_bytes()).map_err(|e| Error::io("writing the manifest", e))?;
    output.commit()?;
    let simplices: u64 = reports.iter().map(|report| report.simplices).sum();
    let dropped: u64 = reports.iter().map(|report| report.dropped).sum();
    let (points, parts) = (plan.points, reports.len());
    tell(
        common,
        &format!(
            "{parts} parts, {simplices} simplices; {points} points, all accounted for ({dropped} dropped, {} merged)",
            manifest.merged
        ),
    );
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
fn policy_of(plan: &Plan, work: &WorkFlags) -> Result<Policy> {
    use clap::ValueEnum;
    let folder = super::outputs::Folder { path: &work.dir, plan };
    for node in &plan.nodes {
        if let Some(report) = folder.report(node.number)? {
            let name = report.options.strip_prefix("duplicates ").unwrap_or_default();
            return Policy::from_str(name, true).map_err(|_| {
                Error::malformed(format!("options {:?} of node {}", report.options, node.number))
            });
        }
    }
    Ok(Policy::First)
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

/// The folder of the parts as seen from the folder of the manifest: relative if it is inside of it, so that both can
/// be moved together.
fn relative(folder: &Path, manifest: &Path) -> Result<PathBuf> {
    let finding = |e| Error::io("finding the folder of the parts", e);
    let folder = std::fs::canonicalize(folder).map_err(finding)?;
    let home = manifest.parent().filter(|home| !home.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let home = std::fs::canonicalize(home).map_err(finding)?;
    Ok(folder.strip_prefix(&home).map_or(folder.clone(), Path::to_path_buf))
}
