//! The same frames in all formats, which MDAnalysis wrote; and damaged ones.

use std::io::Cursor;
use std::path::PathBuf;

use super::*;
use crate::molecules::read_structure;
use spmesh_base::error::ErrorKind;
use spmesh_base::random::Random;

const FORMATS: [&str; 4] = ["xtc", "trr", "dcd", "gro"];
const ATOMS: usize = 170;
const FRAMES: usize = 3;

fn sample(name: &str) -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/data/")).join(name)
}

fn bytes(ending: &str) -> Vec<u8> {
    std::fs::read(sample(&format!("frames.{ending}"))).unwrap()
}

fn topology() -> Structure {
    first_model(read_structure(&sample("frames.gro"), None).unwrap())
}

fn reader(bytes: Vec<u8>, range: &str, topology: Option<&Structure>) -> Result<FrameReader> {
    FrameReader::of_input(Cursor::new(bytes), "in".into(), None, range.parse().unwrap(), topology)
}

/// Numbers and world coordinates of all frames.
fn frames(mut reader: FrameReader) -> Result<Vec<(i64, Vec<Point3>)>> {
    let (mut state, mut frames) = (reader.topology().cloned(), Vec::new());
    while let Some(frame) = reader.next_frame()? {
        let structure = frame.put(&mut state);
        let model = &structure.models[0];
        let points = model.points.iter().map(|&point| structure.coordinates.to_world(point)).collect();
        frames.push((model.number, points));
    }
    Ok(frames)
}

#[test]
fn all_formats_have_the_same_frames() {
    let topology = topology();
    let read = |ending: &str, range| frames(reader(bytes(ending), range, Some(&topology))?);
    let [rounded, trr, dcd, gro] = FORMATS.map(|ending| read(ending, ":").unwrap());
    assert_eq!(rounded.len(), FRAMES);
    assert!(rounded.iter().zip(0..).all(|(frame, number)| frame.0 == number && frame.1.len() == ATOMS));
    assert_eq!(rounded, gro);
    for exact in [&trr, &dcd] {
        let all = exact.iter().zip(&gro).flat_map(|(a, b)| a.1.as_flattened().iter().zip(b.1.as_flattened()));
        // Half a step of 0.01 Å, and f32.
        assert!(all.into_iter().all(|(a, b)| (a - b).abs() < 0.00501));
    }
    assert!(trr.iter().zip(&dcd).all(|(a, b)| {
        a.1.as_flattened().iter().zip(b.1.as_flattened()).all(|(a, b)| (a - b).abs() < 1e-5)
    }));
    for ending in FORMATS {
        let numbers = |range| read(ending, range).unwrap().iter().map(|frame| frame.0).collect::<Vec<_>>();
        assert_eq!([numbers("::2"), numbers("1"), numbers("1:9")], [vec![0, 2], vec![1], vec![1, 2]]);
        let error = read(ending, "3:").unwrap_err();
        assert!(error.kind() == ErrorKind::Usage && error.to_string().contains("has 3 frames"), "{error}");
    }
}

/// The vectors of the boxes of all frames.
fn boxes(mut reader: FrameReader) -> Vec<[Point3; 3]> {
    let (mut state, mut boxes) = (reader.topology().cloned(), Vec::new());
    while let Some(frame) = reader.next_frame().unwrap() {
        let stated = &frame.put(&mut state).models[0].periodic_box;
        boxes.push(stated.as_ref().unwrap().as_ref().unwrap().vectors());
    }
    boxes
}

/// The sample with another box in its first frame, of these vectors in nm.
fn with_box(ending: &str, vectors: [f32; 9]) -> Vec<u8> {
    let mut bytes = bytes(ending);
    let [ax, ay, az, bx, by, bz, cx, cy, cz] = vectors;
    let (place, new): (_, Vec<u8>) = match ending {
        "xtc" => (16, vectors.iter().flat_map(|c| c.to_be_bytes()).collect()),
        "trr" => (84, vectors.iter().flat_map(|c| c.to_be_bytes()).collect()),
        "gro" => {
            let text = String::from_utf8(bytes).unwrap();
            let numbers = [ax, by, cz, ay, az, bx, bz, cx, cy].map(|c| format!("{c:10.5}"));
            return text.replacen("   6.00000   6.00000   6.00000", &numbers.concat(), 1).into_bytes();
        }
        _ => {
            let length = |[x, y, z]: [f32; 3]| 10.0 * f64::from(x).hypot(y.into()).hypot(z.into());
            let [a, b, c] = [[ax, ay, az], [bx, by, bz], [cx, cy, cz]];
            let cosine = |p: [f32; 3], q: [f32; 3]| {
                100.0 * (0..3).map(|i| f64::from(p[i] * q[i])).sum::<f64>() / length(p) / length(q)
            };
            let cosines = [cosine(b, c), cosine(a, c), cosine(a, b)];
            let [alpha, beta, gamma] = cosines.map(|cosine| cosine.acos().to_degrees());
            let cell = [length(a), gamma, length(b), beta, alpha, length(c)];
            let title = 92 + 8 + u32::from_le_bytes(*bytes[92..].first_chunk().unwrap()) as usize;
            (title + 12 + 4, cell.iter().flat_map(|c| c.to_le_bytes()).collect())
        }
    };
    bytes[place..place + new.len()].copy_from_slice(&new);
    bytes
}

#[test]
fn each_frame_has_the_box_that_it_states() {
    let topology = topology();
    for vectors in
        [[4.0, 0.0, 0.0, 0.0, 5.0, 0.0, 0.0, 0.0, 6.5], [4.0, 0.0, 0.0, -1.0, 5.0, 0.0, 2.0, 1.5, 6.5]]
    {
        for ending in FORMATS {
            let found = boxes(reader(with_box(ending, vectors), ":", Some(&topology)).unwrap());
            let expected = vectors.map(|c| 10.0 * f64::from(c));
            let first = found[0].as_flattened();
            assert!(first.iter().zip(expected).all(|(c, d)| (c - d).abs() < 1e-5), "{ending}: {first:?}");
            let cube = [[60.0, 0.0, 0.0], [0.0, 60.0, 0.0], [0.0, 0.0, 60.0]];
            assert_eq!(found[1..], [cube; FRAMES - 1], "{ending}");
        }
    }
    // Numbers that fill their columns touch, and zeros are no box.
    let touching = with_box("gro", [1000.5, 0.0, 0.0, -1000.25, 2000.0, 0.0, 0.0, 0.0, 3000.0]);
    assert_eq!(boxes(reader(touching, "0", None).unwrap())[0][1], [-10_002.5, 20_000.0, 0.0]);
    for ending in ["xtc", "trr", "gro"] {
        let mut frames = reader(with_box(ending, [0.0; 9]), "0", Some(&topology)).unwrap();
        let mut state = Some(topology.clone());
        let frame = frames.next_frame().unwrap().unwrap();
        assert_eq!(frame.put(&mut state).models[0].periodic_box, None);
    }
}

/// Byte orders of DCD are those of machines.
#[test]
fn dcd_is_read_in_both_byte_orders() {
    let little = bytes("dcd");
    let (topology, swap) = (topology(), |words: &[u8]| -> Vec<u8> {
        words.as_chunks::<4>().0.iter().flat_map(|&word| word.into_iter().rev()).collect()
    });
    // The texts `CORD` and the title keep their order, and the doubles of the cell are not used.
    let title = 92 + 4 + u32::from_le_bytes(*little[92..].first_chunk().unwrap()) as usize;
    let mut big = swap(&little);
    big[4..8].copy_from_slice(b"CORD");
    big[100..title].copy_from_slice(&little[100..title]);
    let read = |bytes| frames(reader(bytes, ":", Some(&topology)).unwrap()).unwrap();
    assert_eq!(read(little), read(big));
}

#[test]
fn what_does_not_fit_is_refused() {
    let mut small = topology();
    small.models[0].points.pop();
    for ending in FORMATS {
        let error = frames(reader(bytes(ending), ":", Some(&small)).unwrap()).unwrap_err();
        let text = error.to_string();
        assert!(error.kind() == ErrorKind::Usage && text.contains("170 atoms, the topology 169"), "{text}");
        assert!(text.starts_with("in: frame 0"), "{text}");
        let whole = bytes(ending);
        let cut = whole[..whole.len() - 99].to_vec();
        let error = frames(reader(cut.clone(), ":", Some(&topology())).unwrap()).unwrap_err().to_string();
        let found = if ending == "gro" { "line 517: the line ends" } else { "frame 2 at byte" };
        assert!(error.contains(found), "{error}");
        // What is before the damage can be taken.
        assert_eq!(frames(reader(cut, ":2", Some(&topology())).unwrap()).unwrap().len(), 2);
        let error = reader(whole, ":", None).and_then(frames);
        assert_eq!(error.is_ok(), ending == "gro");
    }
}

/// Readers return, whatever the bytes are: each mutant is a sample with flipped, changed or cut bytes.
#[test]
fn damaged_frames_are_errors() {
    const MUTANTS: usize = 2000;
    let topology = topology();
    let (mut random, mut failed) = (Random::new(66), 0);
    for ending in FORMATS {
        let whole = bytes(ending);
        for _ in 0..MUTANTS {
            let mut mutant = whole.clone();
            for _ in 0..1 + random.bits() % 4 {
                // Most numbers that matter are at the start of a frame.
                let place = random.bits() as usize % if random.bits() % 2 == 0 { 300 } else { mutant.len() };
                mutant[place] = match random.bits() % 3 {
                    0 => mutant[place] ^ 1 << (random.bits() % 8),
                    1 => [0, 0x7f, 0x80, 0xff][random.bits() as usize % 4],
                    _ => random.bits() as u8,
                };
            }
            if random.bits() % 4 == 0 {
                mutant.truncate(random.bits() as usize % mutant.len());
            }
            let range = if random.bits() % 4 == 0 { "2" } else { ":" };
            failed += usize::from(reader(mutant, range, Some(&topology)).and_then(frames).is_err());
        }
    }
    assert!(failed > MUTANTS, "{failed}");
}
