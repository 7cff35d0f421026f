//! Any target for libFuzzer: the one that the variable `FUZZ_TARGET` names.

#![no_main]

use std::sync::OnceLock;

use spmesh_fuzz::Target;

static TARGET: OnceLock<Target> = OnceLock::new();

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let target = TARGET.get_or_init(|| {
        let name = std::env::var("FUZZ_TARGET").expect("FUZZ_TARGET names a target of scripts/fuzz --list");
        spmesh_fuzz::target(&name).expect("FUZZ_TARGET names a target of scripts/fuzz --list")
    });
    target.run(bytes);
});
