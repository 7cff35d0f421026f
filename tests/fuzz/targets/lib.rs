//! Fuzz targets: functions that take any bytes and panic if something is wrong. libFuzzer and the seeded
//! driver of this crate call them.
//!
//! Readers must read the whole input or return an error, without a panic, in memory bounded by the size of
//! the input, whatever sizes it states. The results of kernels must pass independent exact proofs.

mod files;
mod kernels;
pub mod mutation;
mod points;
// The tests of the kernel use more of this module.
#[allow(dead_code)]
#[path = "../../geometry/kernel3/promises.rs"]
mod promises;
pub mod samples;
mod streams;

use samples::Samples;

/// A named target.
#[derive(Clone, Copy)]
pub struct Target {
    /// Name of the target, and of its file in `fuzz_targets`.
    pub name: &'static str,
    /// Runs the target on some bytes.
    ///
    /// # Panics
    /// If the bytes reveal a fault.
    pub run: fn(&[u8]),
    /// The initial inputs.
    pub samples: Samples,
}

/// All targets.
pub const TARGETS: [Target; 19] = [
    Target { name: "stream", run: streams::stream, samples: Samples::Vectors },
    Target { name: "twin", run: streams::twin, samples: Samples::Twins },
    Target { name: "las", run: files::points, samples: Samples::Files(&["las", "laz"]) },
    Target { name: "text", run: files::points, samples: Samples::Texts(samples::TEXTS) },
    Target { name: "sp", run: files::points, samples: Samples::Texts(samples::SPA) },
    Target { name: "ply", run: files::ply, samples: Samples::Texts(samples::PLY) },
    Target { name: "obj", run: files::obj, samples: Samples::Texts(samples::OBJ) },
    Target { name: "sma", run: files::sma, samples: Samples::Texts(samples::SMA) },
    Target { name: "vtk", run: files::points, samples: Samples::Files(&["vtk", "vtu", "vtp"]) },
    Target { name: "pdb", run: files::pdb, samples: Samples::Files(&["pdb"]) },
    Target { name: "mmcif", run: files::mmcif, samples: Samples::Files(&["cif"]) },
    Target { name: "molecule", run: files::molecule, samples: Samples::Texts(samples::MOLECULES) },
    Target { name: "volume", run: files::volume, samples: Samples::Files(&["nrrd", "nii"]) },
    Target { name: "polylines", run: files::polylines, samples: Samples::Texts(samples::POLYLINES) },
    Target { name: "condition", run: files::condition, samples: Samples::Texts(samples::CONDITIONS) },
    Target { name: "kernel2", run: kernels::kernel2, samples: Samples::Points },
    Target { name: "kernel3", run: kernels::kernel3, samples: Samples::Points },
    Target { name: "diagram4", run: kernels::diagram4, samples: Samples::Points },
    Target { name: "configurations", run: kernels::configurations, samples: Samples::Points },
];

/// The target with a name.
#[must_use]
pub fn target(name: &str) -> Option<Target> {
    TARGETS.into_iter().find(|target| target.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mutation::Inputs;

    /// A short fuzzing run: a few inputs of every target, including the samples.
    #[test]
    fn every_target_passes_a_few_inputs() {
        for target in TARGETS {
            let inputs = Inputs::new(target.samples, 1);
            for number in 0..40 {
                (target.run)(&inputs.input(number));
            }
        }
    }

    #[test]
    fn every_target_has_a_file_for_libfuzzer() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../fuzz_targets");
        let mut found: Vec<String> = std::fs::read_dir(folder)
            .expect("the folder of targets")
            .map(|entry| entry.expect("an entry").path())
            .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
            .collect();
        found.sort_unstable();
        let mut names = TARGETS.map(|target| target.name);
        names.sort_unstable();
        assert_eq!(found, names);
    }
}
