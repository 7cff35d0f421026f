#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    (spmesh_fuzz::target("twin").expect("a target of this name").run)(bytes);
});
