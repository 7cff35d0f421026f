//! Damaged structures: whichever byte is wrong, reading ends with atoms or an error, within bounded memory.

use super::sample;
use super::structure::{atoms, gzip, read};
use crate::allocation::largest_during;
use crate::programs::Folder;
use spmesh_base::error::ErrorKind;
use spmesh_formats::molecules::read_structure;

/// Largest single allocation that a damaged small file may cause: buffers for reading.
const ALLOCATION_MAX: usize = 1 << 18;

/// Samples in all formats, as they are read from memory.
fn samples() -> Vec<(&'static str, Vec<u8>)> {
    let xyz = "3\nwater\nO 0.000 0.000 0.1173\nH 0.0 0.7572 -0.4692\nH 0.0 -0.7572 -0.4692\n".repeat(20);
    let file = |name: &str| std::fs::read(sample(name)).unwrap();
    vec![
        ("pdb", file("1aki.pdb")),
        ("cif", file("1aki.cif")),
        ("altloc.cif", file("altloc.cif")),
        ("xyz", xyz.into_bytes()),
        ("off", b"OFF\n2 0 0\n\n1.5 -2 0.003\n4 5 6\n".to_vec()),
        ("pdb.gz", gzip(&file("1aki.pdb")[..3000])),
    ]
}

#[test]
fn every_truncation_keeps_a_part_of_the_atoms_or_is_refused() {
    for (name, whole) in samples() {
        if matches!(name, "off" | "pdb.gz") {
            for len in 0..whole.len() - 2 {
                assert!(read(&whole[..len]).is_err(), "{name} cut at {len}");
            }
            continue;
        }
        let expected = atoms(&read(&whole).unwrap());
        // Every length of small samples and of the end of large ones; every 11th length of the rest.
        let (sparse, dense) =
            (0..whole.len().saturating_sub(4000), whole.len().saturating_sub(4000)..whole.len());
        for len in sparse.step_by(11).chain(dense) {
            let structure = match read(&whole[..len]) {
                Ok(structure) => structure,
                Err(error) => {
                    assert!(matches!(error.kind(), ErrorKind::Malformed | ErrorKind::Usage), "{error}");
                    continue;
                }
            };
            // The last atom's line may be cut after the coordinates; then a warning says so.
            let found = atoms(&structure);
            let is_told = structure.warnings.iter().any(|warning| warning.contains("cut off"));
            let sure = found.len() - usize::from(is_told);
            let same =
                found.iter().zip(&expected).take(sure).filter(|(found, expected)| found == expected).count();
            assert!(found.len() <= expected.len() && same == sure, "{name} cut at {len}: {same} of {sure}");
        }
    }
}

#[test]
fn flipped_bits_are_survived() {
    for (name, whole) in samples() {
        let step = if whole.len() > 5000 { 61 } else { 3 };
        for at in (0..whole.len()).step_by(step) {
            for bit in 0..8 {
                let mut damaged = whole.clone();
                damaged[at] ^= 1 << bit;
                let largest = largest_during(|| drop(read(&damaged)));
                assert!(
                    largest <= ALLOCATION_MAX,
                    "{name}, byte {at}, bit {bit}: a request of {largest} bytes"
                );
            }
        }
    }
}

#[test]
fn numbers_that_lie_allocate_nothing() {
    let texts: [&[u8]; 4] = [
        b"18446744073709551615\n\nC 0 0 0\n",
        b"OFF\n18446744073709551615 0 0\n0 0 0\n",
        b"ply\nformat ascii 1.0\nelement vertex 1000000000\nproperty float x\nproperty float y\nproperty float z\n\
          end_header\n0 0 0\n",
        b"OFF 18446744073709551616\n",
    ];
    for text in texts {
        let largest = largest_during(|| assert!(read(text).is_err()));
        assert!(largest <= ALLOCATION_MAX, "a request of {largest} bytes");
    }
}

#[test]
fn a_file_of_zeros_behind_gzip_is_read_in_pieces() {
    let folder = Folder::new();
    let bomb = gzip(&vec![0; 50 << 20]);
    let path = folder.file("bomb.pdb.gz", &bomb);
    let largest = largest_during(|| assert!(read_structure(&path, None).is_err()));
    assert!(largest <= ALLOCATION_MAX, "a request of {largest} bytes");
}
