//! `spfinalize --plan`: plans for many jobs.

use std::collections::HashSet;
use std::io::Write;
use std::path::{Path, PathBuf};

use clap::Args;

use super::super::roots::RootFlags;
use super::{Flags, TOOL, flags_of};
use crate::lines::Target;
use crate::plan::{Naming, NodeKind, Plan, Planning, SkipList, plan_of};
use crate::reduce::Duplicates;
use spmesh_base::error::{Error, Result, counted, counted_of};
use spmesh_base::output::Output;
use spmesh_formats::source::Survey;
use spmesh_shell::endings;
use spmesh_shell::notice;
use spmesh_shell::progress::Progress;
use spmesh_shell::say;
use spmesh_stream::Kind;

/// Points of a leaf by default: minutes of work on one core.
const LEAF_POINTS: u64 = 50_000_000;

/// Flags of this run alone, which are not part of the plan: so equal plans have equal names.
const ALONE: [&str; 4] = ["-q", "--quiet", "--stats", "--hash"];
const WITH_VALUE: [&str; 11] = [
    "--plan",
    "--leaf-points",
    "--duplicates",
    "--root",
    "--skip-bad",
    "--lof",
    "--memory",
    "--threads",
    "--temp-dir",
    "--spool",
    "--progress",
];

/// Flags of plans.
#[derive(Debug, Args)]
pub(super) struct PlanFlags {
    /// Write a plan for many jobs into this file, from headers alone, and read no points: which boxes there
    /// are, and which files reach into each (see spnode)
    #[arg(long, value_name = "FILE", conflicts_with_all = ["output", "level", "preserve", "salvage"])]
    pub(super) plan: Option<PathBuf>,

    #[arg(long, value_name = "N", requires = "plan", value_parser = clap::value_parser!(u64).range(1..), help = format!("With --plan: points of a leaf, a job, at most [default: {LEAF_POINTS}]"))]
    leaf_points: Option<u64>,

    /// With --plan: elevation of a vertex where points coincide in x and y
    #[arg(long, value_enum, default_value_t = Duplicates::First, value_name = "POLICY", requires = "plan")]
    duplicates: Duplicates,

    /// With --plan: know files by their contents, which are read for it, and not by their lengths and times
    #[arg(long, requires = "plan")]
    hash: bool,

    /// With --plan: leave out files that cannot be read, and list them in FILE, one in each line. Files that
    /// it lists already are left out, too, until they change; a job that finds a damaged file says its name
    /// for it
    #[arg(long, value_name = "FILE", requires = "plan")]
    skip_bad: Option<PathBuf>,

    #[command(flatten)]
    roots: RootFlags,
}

impl PlanFlags {
    fn naming(&self) -> Result<Naming> {
        Ok(Naming { roots: self.roots.roots()?, by_content: self.hash })
    }
}

/// Makes a plan.
pub(super) fn make(flags: &Flags, path: &Path) -> anyhow::Result<()> {
    endings::check(path, &[endings::JSON])?;
    check_flags(flags)?;
    let mut paths = flags.paths()?;
    if let Some(stdin) = paths.iter().chain(flags.beside()).find(|path| path.as_os_str() == "-") {
        let message = "plans need files, which jobs read later: give their names";
        return Err(Error::usage(message).of_input(stdin.display().to_string()).into());
    }
    let list = flags.plan.skip_bad.as_deref();
    let mut bad = list.map_or(Ok(SkipList::default()), SkipList::read)?;
    let given = paths.clone();
    let unknown = bad.unknown(&given);
    if let Some(first) = unknown.first() {
        let all = counted(unknown.len() as u64, "file", "files");
        let message = format!("--skip-bad lists {all} not among the inputs, such as {}", first.display());
        notice(TOOL, &flags.common, &message);
    }
    paths.retain(|path| !bad.has(path));
    let mut output = Output::create(path, false)?;
    let mut progress = Progress::counting("files", &flags.common, "headers", Some(paths.len() as u64));
    let survey = Survey::of(&paths, &flags.source_options()?, list.is_some(), |done| progress.set(done))?;
    drop(progress);
    flags.notice_some(&survey.notices);
    leave_out(&mut paths, &survey, &mut bad)?;
    let skipped = bad.skipped(&given);
    let leaf_points = flags.plan.leaf_points.unwrap_or(LEAF_POINTS);
    let arguments = arguments_beside(&flags.inputs)?;
    check_arguments(flags, &arguments)?;
    let beside: Vec<PathBuf> = flags.areas.files().chain(flags.water.files()).cloned().collect();
    let planning = Planning {
        leaf_points,
        arguments: &arguments,
        beside: &beside,
        duplicates: flags.plan.duplicates,
        naming: &flags.plan.naming()?,
        skipped: &skipped,
    };
    let plan = plan_of(&survey, &paths, planning)?;
    check_water(flags, &plan)?;
    output.write_all(plan.to_json()?.as_bytes()).map_err(|e| Error::io("writing the plan", e))?;
    if let Some(list) = list {
        // Before the plan gets its name: the list is refused if it would replace a file of the plan.
        plan.note_files()?;
        bad.write(list)?;
        if !skipped.is_empty() {
            let files = counted(skipped.len() as u64, "bad file is", "bad files are");
            notice(TOOL, &flags.common, &format!("{files} left out: see {}", list.display()));
        }
    }
    output.commit()?;
    if !flags.common.quiet {
        say(&summary(&plan));
    }
    Ok(())
}

/// Refuses water whose levels are not stated, and says how much of it no job adds.
fn check_water(flags: &Flags, plan: &Plan) -> anyhow::Result<()> {
    if flags.water.files().is_empty() {
        return Ok(());
    }
    let target = Target::of(&plan.header(Kind::Points)?);
    let [uncovered, all] = flags.recipe()?.stated_water(&target, |place| plan.has_files_at(place))?;
    if uncovered > 0 {
        let vertices = counted_of(uncovered, all, ["vertex of water", "vertices of water"], ["is", "are"]);
        notice(TOOL, &flags.common, &format!("{vertices} where no file has points, and left out"));
    }
    Ok(())
}

/// Takes bad files out of `paths`, and lists them.
fn leave_out(paths: &mut Vec<PathBuf>, survey: &Survey, list: &mut SkipList) -> Result<()> {
    for (number, error) in survey.bad.iter().rev() {
        list.add(&paths.remove(*number), error)?;
    }
    list.settle(paths);
    Ok(())
}

/// Refuses what takes more than the points of one leaf.
fn check_flags(flags: &Flags) -> anyhow::Result<()> {
    let of_all = [
        ("--thin", flags.points.thin.is_some()),
        ("--lines", !flags.lines.files.is_empty()),
        ("--radii and --weights", flags.weights.load()?.is_some()),
    ];
    match of_all.iter().find(|(_, is_given)| *is_given) {
        None => Ok(()),
        Some((flag, _)) => {
            let message =
                format!("{flag} does not go with --plan: jobs see the points of their own boxes alone");
            Err(Error::usage(message).into())
        }
    }
}

/// The arguments of the program that say which points count, and how files are read.
fn arguments_beside(files: &[PathBuf]) -> Result<Vec<String>> {
    let files: HashSet<&PathBuf> = files.iter().collect();
    let mut is_value = false;
    let others = std::env::args_os().skip(1).filter(|argument| {
        let text = argument.to_string_lossy();
        let (flag, value) = text.split_once('=').map_or((&*text, None), |(flag, value)| (flag, Some(value)));
        let is_of_run = ALONE.contains(&flag) || WITH_VALUE.contains(&flag);
        let is_dropped = is_value || is_of_run;
        is_value = !is_value && value.is_none() && WITH_VALUE.contains(&flag);
        !is_dropped && !files.contains(&PathBuf::from(argument))
    });
    let text = |argument: std::ffi::OsString| {
        argument
            .into_string()
            .map_err(|other| Error::usage(format!("{other:?} is not UTF-8, which plans need")))
    };
    others.map(text).collect()
}

/// Checks that jobs will read the arguments as this program does. They would not if the value of a flag were
/// also the name of a file.
fn check_arguments(flags: &Flags, arguments: &[String]) -> Result<()> {
    let text = |flags: &Flags| {
        format!(
            "{:?}",
            (
                &flags.points,
                &flags.areas,
                &flags.text,
                &flags.crs,
                &flags.attributes,
                flags.scale,
                flags.offset,
                flags.raw,
                flags.octree,
                &flags.water
            )
        )
    };
    match flags_of(arguments) {
        Ok(again) if text(&again) == text(flags) => Ok(()),
        _ => Err(Error::usage("a value of a flag is also the name of a file: give the file as ./NAME")),
    }
}

fn summary(plan: &Plan) -> String {
    let leaves = plan.nodes.iter().filter(|node| node.kind() == NodeKind::Leaf);
    let largest = leaves.clone().map(|leaf| leaf.points).max().unwrap_or(0);
    let reads: usize = leaves.clone().map(|leaf| leaf.files.len()).sum();
    let files = plan.files.iter().filter(|file| file.points > 0).count().max(1);
    format!(
        "files           {}\npoints          {}\nleaves          {}\ninner nodes     {}\nstages          {}\n\
         largest leaf    {largest} points expected\nreads of a file {:.2} on average\n",
        plan.files.len(),
        plan.points,
        leaves.count(),
        plan.nodes.len() - plan.stages[0][1] as usize - 1,
        plan.stages.len(),
        reads as f64 / files as f64,
    )
}
