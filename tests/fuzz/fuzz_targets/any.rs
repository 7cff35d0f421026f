//! Any target for libFuzzer: the one that the variable `FUZZ_TARGET` names.
//!
//! With the variable `FUZZ_SAMPLES`, prints the names of all targets instead, and writes their samples into
//! folders of these names in the folder that it names.

#![no_main]

use std::path::Path;
use std::sync::OnceLock;

use spmesh_fuzz::{TARGETS, Target, target};

static TARGET: OnceLock<Target> = OnceLock::new();

/// The same samples for each run.
const SEED: u64 = 1;

fn write_samples(folder: &Path) {
    for target in TARGETS {
        target.write_samples(&folder.join(target.name), SEED);
        println!("{}", target.name);
    }
}

libfuzzer_sys::fuzz_target!(
    init: {
        if let Some(folder) = std::env::var_os("FUZZ_SAMPLES") {
            write_samples(folder.as_ref());
            std::process::exit(0);
        }
    },
    |bytes: &[u8]| {
        let target = TARGET.get_or_init(|| {
            let wanted = "FUZZ_TARGET names a target of scripts/fuzz --list";
            target(&std::env::var("FUZZ_TARGET").expect(wanted)).expect(wanted)
        });
        target.run(bytes);
    }
);
