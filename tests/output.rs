//! Output files are complete or absent.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use spmesh_base::output::Output;

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort_unstable();
    names
}

fn write(path: &Path, text: &str) -> Output {
    let mut output = Output::create(path, true).unwrap();
    output.write_all(text.as_bytes()).unwrap();
    assert_eq!(output.bytes_written(), text.len() as u64);
    output
}

#[test]
fn a_file_appears_when_it_is_committed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.spm");
    let output = write(&path, "new");
    assert!(!path.exists());
    output.commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(names(folder.path()), ["mesh.spm"]);
}

#[test]
fn an_old_file_stays_until_the_new_one_is_complete() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mesh.spm");
    fs::write(&path, "old").unwrap();
    drop(write(&path, "half"));
    assert_eq!(fs::read_to_string(&path).unwrap(), "old");
    write(&path, "new").commit().unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), "new");
    assert_eq!(names(folder.path()), ["mesh.spm"]);
}

#[test]
fn a_symbolic_link_leads_to_the_new_file() {
    let folder = tempfile::tempdir().unwrap();
    let [target, link]: [PathBuf; 2] = ["target.spm", "link.spm"].map(|name| folder.path().join(name));
    fs::write(&target, "old").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    write(&link, "new").commit().unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(fs::read_to_string(&target).unwrap(), "new");
    assert_eq!(names(folder.path()), ["link.spm", "target.spm"]);
}

#[test]
fn a_folder_that_is_not_there_is_named() {
    let error = Output::create(Path::new("/no/such/folder/mesh.spm"), true).err().unwrap();
    assert!(error.to_string().contains("/no/such/folder/mesh.spm"), "{error}");
    assert_eq!(error.exit_code(), 1);
}
