//! Fuzz targets: functions that take any bytes and panic if something is wrong. libFuzzer and the seeded
//! driver of this crate call them.
//!
//! Readers must read the whole input or return an error, without a panic, in memory bounded by the size of
//! the input, whatever sizes it states. The results of kernels must pass independent exact proofs.

mod commands;
mod constrained;
mod files;
mod geographic;
mod kernels;
mod made;
pub mod mutation;
mod points;
// The tests of the kernel use more of this module.
#[allow(dead_code)]
#[path = "../../geometry/kernel3/promises.rs"]
mod promises;
mod reduction;
pub mod samples;
mod streams;

use std::fs;
use std::path::Path;

use mutation::Inputs;
use samples::{Made, Samples};

/// A named target.
#[derive(Clone, Copy)]
pub struct Target {
    /// Its name.
    pub name: &'static str,
    task: Task,
    /// The initial inputs.
    pub samples: Samples,
}

/// What a target does with bytes.
#[derive(Clone, Copy)]
enum Task {
    /// Calls a function.
    Call(fn(&[u8])),
    /// Writes the bytes to files, and runs these command lines of programs; see [`commands`].
    Commands(&'static [&'static str]),
}

impl Target {
    /// Runs the target on some bytes.
    ///
    /// # Panics
    /// If the bytes reveal a fault.
    pub fn run(&self, bytes: &[u8]) {
        match self.task {
            Task::Call(function) => function(bytes),
            Task::Commands(lines) => commands::run(lines, bytes),
        }
    }

    /// Writes the first inputs as files of a folder.
    ///
    /// # Panics
    /// If the folder is not writable.
    pub fn write_samples(&self, folder: &Path, seed: u64) {
        fs::create_dir_all(folder).expect("a writable folder");
        let inputs = Inputs::new(self.samples, seed);
        for number in 0..inputs.first() {
            fs::write(folder.join(format!("sample-{number}")), inputs.input(number))
                .expect("a writable folder");
        }
    }
}

const fn call(name: &'static str, function: fn(&[u8]), samples: Samples) -> Target {
    Target { name, task: Task::Call(function), samples }
}

const fn tools(name: &'static str, lines: &'static [&'static str], samples: Samples) -> Target {
    Target { name, task: Task::Commands(lines), samples }
}

/// All targets. Readers come first, then programs with each of the files that they read, then engines.
pub const TARGETS: [Target; 49] = [
    call("stream", streams::stream, Samples::Vectors),
    call("twin", streams::twin, Samples::Twins),
    call("las", files::points, Samples::Made(Made::Las)),
    call("window", files::window, Samples::Made(Made::Las)),
    call("copy", files::copy, Samples::Made(Made::Las)),
    call("lax", files::lax, Samples::Made(Made::Lax)),
    call("text", files::points, Samples::Texts(samples::TEXTS)),
    call("gzip", files::gzip, Samples::Files(&["gz"])),
    call("sp", files::points, Samples::Texts(samples::SPA)),
    call("binary", files::binary, Samples::Made(Made::Binary)),
    call("npy", files::points, Samples::Made(Made::Npy)),
    call("ply", files::ply, Samples::Texts(samples::PLY)),
    call("obj", files::obj, Samples::Texts(samples::OBJ)),
    call("sma", files::sma, Samples::Texts(samples::SMA)),
    call("vtk", files::points, Samples::Files(&["vtk", "vtu", "vtp"])),
    call("pdb", files::pdb, Samples::Files(&["pdb"])),
    call("mmcif", files::mmcif, Samples::Files(&["cif"])),
    call("molecule", files::molecule, Samples::Texts(samples::MOLECULES)),
    call("radii", files::radii, Samples::Texts(samples::RADII)),
    call("volume", files::volume, Samples::Files(&["nrrd", "nii"])),
    call("raw", files::raw, Samples::Texts(samples::TEXTS)),
    call("polylines", files::polylines, Samples::Texts(samples::POLYLINES)),
    call("condition", files::condition, Samples::Texts(samples::CONDITIONS)),
    call("flags", files::flags, Samples::Texts(samples::FLAGS)),
    call("lines", geographic::lines, Samples::Made(Made::Lines)),
    call("shapefile", geographic::shapefile, Samples::Made(Made::Shapefile)),
    call("geopackage", geographic::geopackage, Samples::Files(&["gpkg"])),
    call("wkb", geographic::wkb, Samples::Made(Made::Wkb)),
    call("crs", geographic::crs, Samples::Made(Made::Crs)),
    tools("plan", commands::PLAN, Samples::Made(Made::Plan)),
    tools("report", commands::REPORT, Samples::Made(Made::Report)),
    tools("manifest", commands::MANIFEST, Samples::Made(Made::Manifest)),
    tools("resume", commands::RESUME, Samples::Made(Made::Summary)),
    tools("masks", commands::MASKS, Samples::Made(Made::Lines)),
    tools("like", commands::LIKE, Samples::Made(Made::Raster)),
    tools("parts", commands::PARTS, Samples::Texts(samples::PARTS)),
    tools("reduce", commands::REDUCE, Samples::Vectors),
    tools("surface", commands::SURFACE, Samples::Vectors),
    tools("convert", commands::CONVERT, Samples::Vectors),
    tools("solid", commands::SOLID, Samples::Vectors),
    tools("splines", commands::SPLINES, Samples::Vectors),
    call("kernel2", kernels::kernel2, Samples::Points),
    call("kernel3", kernels::kernel3, Samples::Points),
    call("weighted3", kernels::weighted3, Samples::Points),
    call("diagram4", kernels::diagram4, Samples::Points),
    call("configurations", kernels::configurations, Samples::Points),
    call("reduction2", reduction::plane, Samples::Points),
    call("reduction3", reduction::space, Samples::Points),
    call("constrained", constrained::constrained, Samples::Points),
];

/// The target with a name.
#[must_use]
pub fn target(name: &str) -> Option<Target> {
    TARGETS.into_iter().find(|target| target.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A short fuzzing run: a few inputs of every target, including the samples.
    #[test]
    fn every_target_passes_a_few_inputs() {
        for target in TARGETS {
            let inputs = Inputs::new(target.samples, 1);
            for number in 0..40 {
                target.run(&inputs.input(number));
            }
        }
    }

    #[test]
    fn names_are_different() {
        let mut names = TARGETS.map(|target| target.name);
        names.sort_unstable();
        assert!(names.windows(2).all(|pair| pair[0] != pair[1]), "{names:?}");
    }
}
