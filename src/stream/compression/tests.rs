use super::*;
use crate::Kind;

/// SplitMix64 (Steele, Lea and Flood 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    fn below(&mut self, bound: u32) -> u32 {
        (self.next() % u64::from(bound)) as u32
    }
}

fn header(kind: Kind) -> Header {
    Header::new(kind, Coordinates::I32 { scale: [0.01; 3], offset: [0.0; 3] }, 2, true)
}

/// Compresses and decompresses; returns method and length of the compressed form.
fn round_trip(header: &Header, tag: Tag, payload: &[u8]) -> Option<(u8, usize)> {
    let mut compressor = Compressor::default();
    let compressed = compressor.compress(header, tag, payload)?;
    let mut restored = vec![1, 2, 3];
    Decompressor::default().decompress(compressed, &mut restored).unwrap();
    assert_eq!(restored, payload);
    Some((compressed[0], compressed.len()))
}

fn points(count: usize, mut next: impl FnMut() -> i32) -> Vec<u8> {
    (0..3 * count).flat_map(|_| next().to_le_bytes()).collect()
}

struct Patch {
    new: Vec<[i32; 3]>,
    imported: Vec<u64>,
    triangles: Vec<[u32; 3]>,
    finalized: Vec<u32>,
}

impl Patch {
    fn payload(&self) -> Vec<u8> {
        let mut payload = (1u64 << 40).to_le_bytes().to_vec();
        for count in [self.new.len(), self.imported.len(), self.triangles.len(), self.finalized.len()] {
            payload.extend((count as u32).to_le_bytes());
        }
        payload.extend(self.new.iter().flatten().flat_map(|c| c.to_le_bytes()));
        payload.extend(self.imported.iter().flat_map(|id| id.to_le_bytes()));
        payload.extend(self.triangles.iter().flatten().chain(&self.finalized).flat_map(|v| v.to_le_bytes()));
        payload
    }
}

/// A grid of squares, each of two triangles, row by row.
fn grid(side: u32) -> Patch {
    let at = |column: u32, row: u32| row * side + column;
    let squares = (0..side - 1).flat_map(|row| (0..side - 1).map(move |column| (column, row)));
    let two =
        |(c, r)| [[at(c, r), at(c + 1, r), at(c, r + 1)], [at(c + 1, r), at(c + 1, r + 1), at(c, r + 1)]];
    Patch {
        new: (0..side * side).map(|v| [(v % side) as i32 * 100, (v / side) as i32 * 100, 7]).collect(),
        imported: Vec::new(),
        triangles: squares.flat_map(two).collect(),
        finalized: (0..side * side).collect(),
    }
}

#[test]
fn points_come_back() {
    let header = header(Kind::Points);
    let mut random = Random(1);
    let mut at = 0i32;
    let smooth = points(5000, || {
        at = at.wrapping_add(random.below(1000) as i32);
        at
    });
    let (method, len) = round_trip(&header, Tag::Points, &smooth).unwrap();
    assert_eq!(method, 1);
    assert!(len < 5000 * 5, "{len}");
    for count in [6, 7, 100, 5461, (1 << 20) / 12] {
        round_trip(&header, Tag::Points, &points(count, || 5)).unwrap();
        round_trip(&header, Tag::Points, &points(count, || random.below(1 << 12) as i32));
        assert_eq!(round_trip(&header, Tag::Points, &points(count, || random.next() as i32)), None);
        let mut ends = [i32::MIN, i32::MAX, 0, -1].into_iter().cycle();
        round_trip(&header, Tag::Points, &points(count, || ends.next().unwrap()));
    }
    assert_eq!(round_trip(&header, Tag::Points, &[0; 63]), None);
}

#[test]
fn patches_come_back() {
    let header = header(Kind::TriangleMesh);
    let (method, len) = round_trip(&header, Tag::Patch, &grid(100).payload()).unwrap();
    assert_eq!(method, 2);
    assert!(len < 20_000, "{len}");
    for seed in 0..300 {
        let mut random = Random(seed);
        let (new, imported) = (random.below(40), 3 + random.below(40));
        let vertices = new + imported;
        let spread = 1 + random.below(vertices);
        let triangle = |random: &mut Random| {
            let start = random.below(vertices);
            loop {
                let v: [u32; 3] = std::array::from_fn(|_| (start + random.below(spread.max(3))) % vertices);
                if v[0] != v[1] && v[1] != v[2] && v[2] != v[0] {
                    return v;
                }
            }
        };
        let patch = Patch {
            new: (0..new)
                .map(|_| std::array::from_fn(|_| (random.next() as i32) >> random.below(32)))
                .collect(),
            imported: (0..imported).map(|_| random.next() >> random.below(64)).collect(),
            triangles: (0..random.below(200)).map(|_| triangle(&mut random)).collect(),
            finalized: (0..vertices).filter(|_| random.below(3) == 0).collect(),
        };
        let payload = patch.payload();
        let mut bytes = Vec::new();
        assert!(patch::encode(&payload, &mut Packer::default(), &mut bytes), "seed {seed}");
        let mut restored = Vec::new();
        Decompressor::default().decompress(&bytes, &mut restored).unwrap();
        assert_eq!(restored, payload, "seed {seed}");
    }
}

#[test]
fn what_is_no_patch_of_triangles_becomes_records() {
    let header = header(Kind::TriangleMesh);
    let mut twice = grid(9);
    twice.triangles[3][0] = twice.triangles[3][1];
    let mut beyond = grid(9);
    beyond.triangles[3][0] = 81;
    let mut unsorted = grid(9);
    unsorted.finalized.swap(1, 2);
    for payload in [twice.payload(), beyond.payload(), unsorted.payload(), grid(9).payload()[..600].to_vec()]
    {
        assert_eq!(round_trip(&header, Tag::Patch, &payload).unwrap().0, 3);
    }
}

#[test]
fn other_payloads_become_records() {
    let space = Header::new(Kind::TetrahedralMesh, Coordinates::F64, 3, false);
    for (number, tag) in
        [Tag::Points, Tag::Cells, Tag::Labels, Tag::Walls, Tag::Patch].into_iter().enumerate()
    {
        let payload: Vec<u8> = (0..500 + number as u64).flat_map(|i| (i * i).to_le_bytes()).collect();
        assert_eq!(round_trip(&space, tag, &payload[number..]).unwrap().0, 3);
    }
    assert_eq!(round_trip(&space, Tag::End, &[0; 100]), None);
}

/// Damages compressed payloads behind zstd, where checksums would not find it.
#[test]
fn damaged_payloads_are_refused_or_decode_to_something() {
    let (mut compressor, mut samples) = (Compressor::default(), Vec::new());
    let mut random = Random(5);
    let cloud = points(400, || random.below(3000) as i32);
    for (kind, tag, payload) in [
        (Kind::Points, Tag::Points, cloud),
        (Kind::TriangleMesh, Tag::Patch, grid(12).payload()),
        (Kind::TriangleMesh, Tag::Labels, [1, 2, 3, 4].repeat(50)),
    ] {
        samples.push(compressor.compress(&header(kind), tag, &payload).unwrap().to_vec());
    }
    let (mut decompressor, mut payload, mut refused) = (Decompressor::default(), Vec::new(), 0);
    for number in 0..60_000 {
        let mut bytes = samples[number % samples.len()].clone();
        for _ in 0..1 + random.below(3) {
            let len = if random.below(2) == 0 { bytes.len().min(64) } else { bytes.len() };
            let at = random.below(len as u32) as usize;
            match random.below(4) {
                0 => bytes[at] = random.next() as u8,
                1 => bytes[at] ^= 1 << random.below(8),
                2 => bytes.truncate(at.max(1)),
                _ => bytes.insert(at, random.next() as u8),
            }
        }
        refused += u32::from(decompressor.decompress(&bytes, &mut payload).is_err());
        assert!(payload.len() <= 1 << 20);
    }
    assert!((20_000..60_000).contains(&refused), "{refused}");
}
