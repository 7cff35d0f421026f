//! Programs as users call them, in this process, with the bytes of an input as one of their files.
//!
//! A target has several lines. `put FILE` writes the bytes to a file; `seal FILE` does so with corrected
//! checksums, and with the names of the folder (see [`Here`]); `prove FILE` audits a file, if it is there,
//! and removes it. Every other line is a command. A file name begins with `HERE/`, the folder of the thread,
//! or `DATA/`, the samples of the tests; `NODE2` stands for the name of node 2 of the plan, with its folder.

use std::fs::{self, File};
use std::path::PathBuf;
use std::time::{Duration, UNIX_EPOCH};

use clap::Parser;
use serde_json::Value;
use spmesh_convert::flags::spconvert;
use spmesh_formats::source::{SourceOptions, Survey};
use spmesh_molecules::flags::tess3;
use spmesh_pipeline::flags::{spdelaunay2d, spdelaunay3d, spfinalize, spnode};
use spmesh_pipeline::plan::{Naming, NodeReport, Plan, Planning, hash_of_file, plan_of};
use spmesh_pipeline::reduce::Duplicates;
use spmesh_spacetime::flags::dd4;
use spmesh_splines::flags::{configgen, splinefit};
use spmesh_terrain::flags::{spcanopy, spconstrain, spdem, spdiff, spheight, spsimplify};
use spmesh_view::flags::spview;
use tempfile::TempDir;

use crate::streams::{prove, sealed};

pub const PLAN: &[&str] = &[
    "seal HERE/in.json",
    "spnode list HERE/in.json",
    "spnode run --threads 1 -d HERE/made HERE/in.json 0 4 2",
    "spnode collect -d HERE/parts -o HERE/out.json HERE/in.json",
];

pub const REPORT: &[&str] = &[
    "seal HERE/parts/NODE2.json",
    "spnode collect -d HERE/parts -o HERE/out.json HERE/plan.json",
    "spnode run --threads 1 -d HERE/parts HERE/plan.json 2 4",
];

pub const MANIFEST: &[&str] = &[
    "seal HERE/in.json",
    "spconvert HERE/in.json -o HERE/out.obj",
    "spdem --columns 9 HERE/in.json -o HERE/out.tif",
];

pub const RESUME: &[&str] =
    &["seal HERE/in.tsv", "tess3 --out-dir HERE/made --summary HERE/in.tsv --resume HERE/atoms.pdb"];

/// Lines and polygons beside a sound mesh.
pub const MASKS: &[&str] = &[
    "put HERE/in.geojson",
    "spfinalize --threads 1 --clip HERE/in.geojson HERE/points.txt -o HERE/out.spm",
    "spfinalize --threads 1 --flatten HERE/in.geojson HERE/points.txt -o HERE/out.spm",
    "spdem --columns 9 --mask HERE/in.geojson HERE/mesh.spm -o HERE/out.tif",
    "spconstrain --hull HERE/in.geojson HERE/mesh.spm -o HERE/cut.spm",
    "prove HERE/cut.spm",
    "spconstrain --lines HERE/in.geojson HERE/mesh.spm -o HERE/lines.spm",
    "prove HERE/lines.spm",
];

pub const LIKE: &[&str] = &["put HERE/in.tif", "spdem --like HERE/in.tif HERE/mesh.spm -o HERE/out.tif"];

/// Files of `configgen`, `splinefit`, `dd4` and lists of files.
pub const PARTS: &[&str] = &[
    "put HERE/in.txt",
    "configgen --features HERE/in.txt HERE/points.txt -o HERE/out.spm",
    "configgen --patches HERE/in.txt HERE/points.txt -o HERE/out.spm",
    "configgen -d 2 --values HERE/in.txt HERE/points.txt -o HERE/out.spm",
    "splinefit fit --threads 1 --max-knots 9 --features HERE/in.txt HERE/points.txt -o HERE/out.spm",
    "splinefit fit --threads 1 --max-knots 9 --weights HERE/in.txt HERE/points.txt -o HERE/out.spm",
    "dd4 --grid 2x2x2x2 --at-file HERE/in.txt -o HERE/out.txt",
    "spfinalize --threads 1 --lof HERE/in.txt -o HERE/out.spm",
];

/// What reads points or partial meshes.
pub const REDUCE: &[&str] = &[
    "seal HERE/in.spm",
    "spdelaunay2d --threads 1 --memory 256M HERE/in.spm -o HERE/mesh2.spm",
    "prove HERE/mesh2.spm",
    "spdelaunay2d --merge --incomplete HERE/in.spm HERE/in.spm -o HERE/out.spm",
    "spdelaunay3d --threads 2 --memory 256M HERE/in.spm -o HERE/mesh3.spm",
    "prove HERE/mesh3.spm",
    "spdelaunay3d --merge HERE/in.spm -o HERE/out.spm",
    "spfinalize --threads 1 HERE/in.spm -o HERE/final.spm",
    "prove HERE/final.spm",
    "configgen HERE/in.spm -o HERE/links.spm",
    "prove HERE/links.spm",
];

/// What reads meshes of terrain.
pub const SURFACE: &[&str] = &[
    "seal HERE/in.spm",
    "spdem --columns 9 HERE/in.spm -o HERE/out.tif",
    "spdem --contours 3 --smooth HERE/in.spm -o HERE/out.geojson",
    "spdem --columns 9 --concave 3 --kind slope HERE/in.spm -o HERE/out.asc",
    "spconstrain --lines DATA/lines.txt HERE/in.spm -o HERE/out.spm",
    "spheight --threads 1 --ground HERE/in.spm DATA/hextest.las -o HERE/out.las",
    "spcanopy --threads 1 --columns 9 --ground HERE/in.spm DATA/hextest.las -o HERE/out.tif",
    "spdiff --threads 1 --levels 0:9:3 HERE/in.spm -o HERE/out.tsv",
    "spdiff --threads 1 HERE/in.spm HERE/in.spm -o HERE/out.tsv",
    "spsimplify --threads 1 --tolerance 1 HERE/in.spm -o HERE/out.spm",
    "spview --width 320 HERE/in.spm -o HERE/out.svg",
];

pub const CONVERT: &[&str] = &[
    "seal HERE/in.spm",
    "spconvert HERE/in.spm -o HERE/out.obj",
    "spconvert HERE/in.spm -o HERE/out.ply",
    "spconvert HERE/in.spm -o HERE/out.vtu",
    "spconvert HERE/in.spm -o HERE/out.mesh",
    "spconvert HERE/in.spm -o HERE/out.dxf",
    "spconvert HERE/in.spm --to landxml -o HERE/out.xml",
    "spconvert HERE/in.spm -o HERE/out.spa",
    "spconvert HERE/in.spm -o HERE/out.smb",
    "spconvert HERE/in.spm -o HERE/out.geojson",
    "spconvert HERE/in.spm -o HERE/out.glb",
    "spconvert HERE/in.spm -o HERE/out.stl",
    "spconvert HERE/in.spm -o HERE/out.nc",
    "spconvert HERE/in.spm --compress -o HERE/out.spm",
];

/// What reads tetrahedra and streams of four dimensions.
pub const SOLID: &[&str] = &[
    "seal HERE/in.spm",
    "tess3 --filtration HERE/in.spm -o HERE/out.txt",
    "tess3 --contacts HERE/in.spm -o HERE/out.txt",
    "dd4 HERE/in.spm -o HERE/cells.spm",
    "prove HERE/cells.spm",
    "dd4 --slice 0.5 HERE/in.spm -o HERE/out.ply",
];

pub const SPLINES: &[&str] = &[
    "seal HERE/in.spm",
    "splinefit eval --threads 1 --columns 9 HERE/in.spm -o HERE/out.tif",
    "splinefit fit --threads 1 --knots HERE/in.spm HERE/points.txt -o HERE/out.spm",
    "splinefit mesh HERE/in.spm -o HERE/out.spm",
    "spview --width 320 HERE/in.spm -o HERE/out.svg",
];

/// Points with ties, of which the files of the folder are made.
const POINTS: &str = "0 0 1\n9 0 2\n9 9 3\n0 9 4\n5 5 9\n3 4 2\n7 2 2\n3 4 3\n1 8 0\n6 6 6\n";

/// When files of the folder were changed: plans and summaries say so.
const AGE: Duration = Duration::from_secs(1_000_000_000);

/// Makes the files that commands read.
const SETUP: &[&str] = &[
    "put HERE/points.txt",
    "spfinalize --threads 1 HERE/points.txt -o HERE/points.spm",
    "spdelaunay2d --threads 1 HERE/points.spm -o HERE/mesh.spm",
    "spdem --columns 4 HERE/mesh.spm -o HERE/raster.tif",
];

/// Makes those that are made of a plan and atoms.
const JOBS: &[&str] = &[
    "spnode run --threads 1 -d HERE/parts HERE/plan.json 0 1 2 3 4",
    "spnode collect -d HERE/parts -o HERE/manifest.json HERE/plan.json",
    "tess3 --out-dir HERE/made --summary HERE/summary.tsv HERE/atoms.pdb",
];

const ATOMS: &str = "\
ATOM      1  N   ALA A   1       1.000   2.000   3.000  1.00  0.00           N
ATOM      2  CA  ALA A   1       2.000   2.500   3.000  1.00  0.00           C
ATOM      3  C   ALA A   1       2.000   3.500   4.000  1.00  0.00           C
ATOM      4  O   ALA A   1       3.000   3.000   3.500  1.00  0.00           O
ATOM      5  CB  ALA A   1       1.500   1.000   2.000  1.00  0.00           C
";

/// A folder with the files that commands read.
struct Here {
    folder: TempDir,
    /// Names of the nodes of the plan, with their folders.
    nodes: Vec<String>,
}

/// What stands for the folder in inputs: so an input means the same in every folder.
const FOLDER: &str = "HERE";

thread_local! {
    static HERE: Here = Here::new();
}

impl Here {
    fn new() -> Here {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("atoms.pdb"), ATOMS).expect("a writable folder");
        let mut here = Here { folder, nodes: Vec::new() };
        here.run_all(SETUP);
        for file in ["points.txt", "atoms.pdb"] {
            let file = File::options().append(true).open(here.path(file)).expect("a file of the folder");
            file.set_modified(UNIX_EPOCH + AGE).expect("a writable folder");
        }
        here.nodes = here.write_plan();
        here.run_all(JOBS);
        here
    }

    fn path(&self, name: &str) -> String {
        let names = (0..).zip(&self.nodes);
        let name = names.fold(name.to_string(), |text, (i, name)| text.replace(&format!("NODE{i}"), name));
        format!("{}/{name}", self.root())
    }

    fn root(&self) -> String {
        self.folder.path().display().to_string()
    }

    fn run_all(&self, lines: &[&str]) {
        for line in lines {
            self.run(line, POINTS.as_bytes()).unwrap_or_else(|error| panic!("{line}: {error}"));
        }
    }

    /// Writes a plan as of the program, which takes arguments from its process; returns the names of its
    /// nodes. Its files are relative to the folder, so these are the same in all folders.
    fn write_plan(&self) -> Vec<String> {
        let paths = [PathBuf::from(self.path("points.txt"))];
        let options = SourceOptions { dims: 2, ..SourceOptions::default() };
        let survey = Survey::of(&paths, &options, false, |_| ()).expect("a file of points");
        let roots = [("here".to_string(), PathBuf::from(self.root()))].into();
        let planning = Planning {
            leaf_points: 4,
            arguments: &[],
            beside: &[],
            duplicates: Duplicates::First,
            naming: &Naming { roots, by_content: false },
            skipped: &[],
        };
        let plan = plan_of(&survey, &paths, planning).expect("a plan");
        fs::write(self.path("plan.json"), plan.to_json().expect("a plan")).expect("a writable folder");
        plan.nodes.iter().map(|node| format!("{}/{}", &node.name[..2], node.name)).collect()
    }

    /// Runs a line with some bytes.
    fn run(&self, line: &str, bytes: &[u8]) -> Result<(), String> {
        let data = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/");
        let place = |word: &str| match word.strip_prefix("HERE/") {
            Some(name) => self.path(name),
            None => word.replace("DATA/", data),
        };
        let words: Vec<String> = line.split(' ').map(place).collect();
        match &words[..] {
            [put, path] if put == "put" => fs::write(path, bytes).expect("a writable folder"),
            [seal, path] if seal == "seal" => {
                fs::write(path, self.corrected(bytes)).expect("a writable folder");
            }
            // A program that refuses its input leaves no file.
            [word, path] if word == "prove" => {
                if let Ok(made) = fs::read(path) {
                    fs::remove_file(path).expect("a writable folder");
                    prove(&made);
                }
            }
            [tool, arguments @ ..] => {
                let all = [&[tool.clone(), "-q".into()], arguments].concat();
                return call_tool(tool, &all);
            }
            [] => panic!("an empty line"),
        }
        Ok(())
    }

    /// The bytes with checksums that fit them, if they are a stream, a plan or a report.
    fn corrected(&self, bytes: &[u8]) -> Vec<u8> {
        sealed(bytes).unwrap_or_else(|| {
            let bytes = renamed(bytes.to_vec(), FOLDER, &self.root());
            sealed_report(&bytes).or_else(|| self.sealed_plan(&bytes)).unwrap_or(bytes)
        })
    }

    /// The hash of a plan is that of its text without the hash, and without the places of roots.
    fn sealed_plan(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        let mut value: Value = serde_json::from_slice(bytes).ok()?;
        *value.get_mut("id")? = "".into();
        let roots = std::mem::replace(value.get_mut("roots")?, serde_json::json!({}));
        let bare: Plan = serde_json::from_value(value.clone()).ok()?;
        let path = self.path("bare.json");
        fs::write(&path, serde_json::to_vec(&bare).ok()?).expect("a writable folder");
        value["id"] = hash_of_file(path.as_ref()).expect("a file that was just written").into();
        value["roots"] = roots;
        serde_json::to_vec(&value).ok()
    }
}

/// The bytes with another name of the folder, if they are text.
fn renamed(bytes: Vec<u8>, from: &str, to: &str) -> Vec<u8> {
    String::from_utf8(bytes).map_or_else(|binary| binary.into_bytes(), |text| text.replace(from, to).into())
}

/// A file of the folder, such as `plan.json`, as an input for any folder.
pub fn made(name: &str) -> Vec<u8> {
    HERE.with(|here| {
        let bytes = fs::read(here.path(name)).expect("a file of the folder");
        renamed(bytes, &here.root(), FOLDER)
    })
}

/// Runs all lines with some bytes. Programs may refuse them.
pub fn run(lines: &[&str], bytes: &[u8]) {
    HERE.with(|here| lines.iter().for_each(|line| drop(here.run(line, bytes))));
}

fn call_tool(tool: &str, words: &[String]) -> Result<(), String> {
    match tool {
        "configgen" => parsed(words, configgen::run),
        "dd4" => parsed(words, dd4::run),
        "spcanopy" => parsed(words, spcanopy::run),
        "spconstrain" => parsed(words, spconstrain::run),
        "spconvert" => parsed(words, spconvert::run),
        "spdelaunay2d" => parsed(words, spdelaunay2d::run),
        "spdelaunay3d" => parsed(words, spdelaunay3d::run),
        "spdem" => parsed(words, spdem::run),
        "spdiff" => parsed(words, spdiff::run),
        "spfinalize" => parsed(words, spfinalize::run),
        "spheight" => parsed(words, spheight::run),
        "splinefit" => parsed(words, splinefit::run),
        "spnode" => parsed(words, spnode::run),
        "spsimplify" => parsed(words, spsimplify::run),
        "spview" => parsed(words, spview::run),
        "tess3" => parsed(words, tess3::run),
        other => panic!("no tool {other}"),
    }
}

fn parsed<F: Parser, E: std::fmt::Display>(
    words: &[String],
    run: impl FnOnce(F) -> Result<(), E>,
) -> Result<(), String> {
    let flags = F::try_parse_from(words).unwrap_or_else(|error| panic!("{error}"));
    run(flags).map_err(|error| format!("{error:#}"))
}

fn sealed_report(bytes: &[u8]) -> Option<Vec<u8>> {
    let report: NodeReport = serde_json::from_slice(bytes).ok()?;
    Some(report.to_json().expect("a report").into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every thread has a folder of its own.
    #[test]
    fn an_input_means_the_same_in_every_folder() {
        let load = || ["plan.json", "manifest.json", "parts/NODE2.json"].map(made);
        let other = std::thread::spawn(load).join().expect("a folder");
        let [plan, manifest, report] = load();
        assert_eq!(other[..2], [plan, manifest]);
        HERE.with(|here| {
            for line in ["seal HERE/in.json", "spnode list HERE/in.json"] {
                here.run(line, &other[0]).expect("a plan");
            }
            for line in &MANIFEST[..2] {
                here.run(line, &other[1]).expect("a manifest");
            }
            let read =
                |bytes| -> NodeReport { serde_json::from_slice(&here.corrected(bytes)).expect("a report") };
            let [own, other] = [&report, &other[2]].map(|bytes| read(bytes));
            assert_eq!((own.name, own.residual, own.joined), (other.name, other.residual, other.joined));
        });
    }
}
