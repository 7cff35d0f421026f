//! A part of the tiles of a plan, with all around that decides about them.

use std::path::PathBuf;

use clap::Args;

use super::Flags;
use spmesh_base::error::{Error, Result};
use spmesh_formats::crs::System;
use spmesh_formats::source::SourceOptions;
use spmesh_pipeline::flags::roots::RootFlags;
use spmesh_pipeline::plan::{NodeKind, Plan, PlannedFile};
use spmesh_stream::model::bounds::Bounds;
use spmesh_stream::{Crs, Kind};

/// Arguments of a plan that leave all points in it.
const OF_ALL_POINTS: [&str; 3] = ["--crs", "--scale", "--offset"];

/// The plan, and which of its tiles are wanted.
#[derive(Debug, Args)]
pub(super) struct PlanFlags {
    /// Plan of all tiles, by spfinalize --plan: FILEs are some of them, and get the classes that a run over
    /// all of them would give. Reads what is near these files alone
    #[arg(long, value_name = "PLAN", conflicts_with = "lof")]
    plan: Option<PathBuf>,

    /// The tiles that begin in the box of this leaf of the plan, instead of FILEs
    #[arg(long, value_name = "N", requires = "plan", conflicts_with = "inputs")]
    leaf: Option<u32>,

    #[command(flatten)]
    roots: RootFlags,
}

/// Some tiles of a plan, and what is around them.
pub(super) struct Around {
    /// The tiles that are wanted.
    pub(super) files: Vec<PathBuf>,
    /// All that reach into the halo of these.
    pub(super) inputs: Vec<PathBuf>,
    /// The box of the world of the tiles that are wanted; `None` if they have no points.
    pub(super) window: Option<Bounds>,
    /// The box of the window with its halo.
    reach: Option<Bounds>,
    crs: Crs,
    plan: Plan,
}

impl PlanFlags {
    /// The wanted tiles; `None` without a plan.
    ///
    /// # Errors
    /// Those of plans; usage, if a file is not in the plan or has changed, or it is of some points only.
    pub(super) fn around(&self, flags: &Flags) -> Result<Option<Around>> {
        let Some(path) = &self.plan else {
            let roots = self.roots.roots()?;
            let given = if roots.is_empty() { None } else { Some("--root goes with --plan") };
            return given.map_or(Ok(None), |text| Err(Error::usage(text)));
        };
        if flags.mesh().is_some() {
            let text = "a plan gives classes of tiles, and no mesh: give --out-dir, plan the tiles there, and make \
                        the mesh with spnode";
            return Err(Error::usage(text));
        }
        let mut plan = Plan::read(path)?;
        let of_plan = |e: Error| e.of_input(path.display().to_string());
        plan.move_roots(self.roots.roots()?).map_err(of_plan)?;
        check(&plan).map_err(of_plan)?;
        let wanted = match self.leaf {
            Some(leaf) => of_leaf(&plan, leaf)?,
            None => planned(&plan, &flags.inputs()?)?,
        };
        let crs = plan.header(Kind::Points)?.crs;
        let halo = flags.parameters.parameters().halo(&System::of(&crs)).map_err(of_plan)?;
        let (window, reach, near) = surroundings(&plan, &wanted, halo);
        wanted.iter().chain(&near).try_for_each(|file| file.check(&plan.roots))?;
        let paths = |files: &[&PlannedFile]| files.iter().map(|file| file.path(&plan.roots)).collect();
        let (files, inputs) = (paths(&wanted), paths(&near));
        Ok(Some(Around { files, inputs, window, reach, crs, plan }))
    }
}

/// The box of the world of the wanted files, that box with its halo, and all files that reach into it.
fn surroundings<'p>(
    plan: &'p Plan,
    wanted: &[&'p PlannedFile],
    halo: f64,
) -> (Option<Bounds>, Option<Bounds>, Vec<&'p PlannedFile>) {
    let Some(window) = wanted.iter().filter_map(|file| plan.in_world(file)).reduce(Bounds::union) else {
        return (None, None, wanted.to_vec());
    };
    let mut reach = Bounds { min: [f64::NEG_INFINITY; 3], max: [f64::INFINITY; 3] };
    for axis in 0..2 {
        (reach.min[axis], reach.max[axis]) = (window.min[axis] - halo, window.max[axis] + halo);
    }
    let is_near = |file: &&PlannedFile| plan.in_world(file).is_some_and(|bounds| bounds.meets(&reach));
    let mut near: Vec<&PlannedFile> = plan.files.iter().filter(is_near).collect();
    // Those without points are in no box.
    near.extend(wanted.iter().filter(|file| file.points == 0));
    (Some(window), Some(reach), near)
}

/// The files that begin in a leaf.
fn of_leaf(plan: &Plan, number: u32) -> Result<Vec<&PlannedFile>> {
    let node = plan.node(number)?;
    if node.kind() != NodeKind::Leaf {
        return Err(Error::usage(format!("node {number} is no leaf: spnode list --stage 0 lists them")));
    }
    Ok(plan.files_from(node).collect())
}

/// The files of a plan at these paths.
fn planned<'p>(plan: &'p Plan, paths: &[PathBuf]) -> Result<Vec<&'p PlannedFile>> {
    let is_in_plan = |(path, found): (&PathBuf, Option<&'p PlannedFile>)| {
        let strange = || Error::usage("is no file of the plan: plan again with all tiles");
        found.ok_or_else(|| strange().of_input(path.display().to_string()))
    };
    paths.iter().zip(plan.files_at(paths)?).map(is_in_plan).collect()
}

/// Refuses a plan of space, or of some of the points.
fn check(plan: &Plan) -> Result<()> {
    if plan.dims() != 2 {
        return Err(Error::usage("the plan is of space (--octree): make one without this flag"));
    }
    let flag = plan.arguments.iter().filter(|argument| argument.starts_with("--")).find(|argument| {
        let flag = argument.split_once('=').map_or(argument.as_str(), |(flag, _)| flag);
        !OF_ALL_POINTS.contains(&flag)
    });
    match flag {
        None => Ok(()),
        Some(flag) => Err(Error::usage(format!(
            "the plan was made with {flag}, and classes depend on all points: make one for this step without it"
        ))),
    }
}

impl Around {
    /// How the inputs are read: as parts of the plan.
    pub(super) fn options(&self, options: SourceOptions) -> SourceOptions {
        SourceOptions {
            encoding: Some(self.plan.coordinates()),
            crs: Some(self.crs.clone()),
            reach: self.reach,
            ..options
        }
    }

    /// Refuses outputs that are files of the plan: other jobs read them.
    ///
    /// # Errors
    /// Usage.
    pub(super) fn check_outputs(&self, outputs: &[PathBuf]) -> Result<()> {
        let Some(file) = self.plan.files_at(outputs)?.into_iter().flatten().next() else { return Ok(()) };
        let text = "is a tile of the plan, and would be replaced: give another --out-dir";
        Err(Error::usage(text).of_input(file.name()))
    }
}
