mod config;
#[allow(dead_code)]
mod reference;
fn main() {}
