//! Writes a synthetic LIDAR survey: overlapping swaths flown back and forth over hills and scanned in zig-zag
//! lines. Points come in the order of acquisition, quantised to 0.01; about 0.5 % of them lie exactly above
//! another one. The same arguments give the same points everywhere.

use std::f64::consts::TAU;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Parser;
use las::point::Format;
use las::{Builder, PointDataBuilder, Vlr, Writer};
use spmesh_base::random::Random;

/// Meters per step of the integer coordinates.
const SCALE: f64 = 0.01;
/// Points per square meter of one swath.
const DENSITY: f64 = 4.0;
/// Widest swath in meters, and its share that the next swath covers again.
const SWATH_WIDTH_MAX: f64 = 500.0;
const OVERLAP: f64 = 0.3;
const LINES_MIN: u64 = 4;
/// Share of points with another point exactly above.
const DUPLICATES: f64 = 0.005;
/// Share of points on vegetation, and its greatest height in meters.
const VEGETATION: f64 = 0.15;
const VEGETATION_HEIGHT: f64 = 18.0;
/// Lower left corner of the survey in meters, UTM zone 10 north.
const ORIGIN: [f64; 2] = [500_000.0, 4_100_000.0];
const EPSG: u16 = 26910;
/// Points that the threads compress together.
const SLAB_POINTS: usize = 16 * 50_000;
const RECORD_LEN: usize = 28;

type Failure = Box<dyn std::error::Error>;

/// Write a seeded synthetic LIDAR survey as LAZ (or LAS, by the extension of the name).
#[derive(Parser)]
struct Arguments {
    /// Total number of points
    #[arg(long, default_value_t = 1_000_000)]
    points: u64,
    /// Seed of all randomness
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Cut the survey into NxM tiles, named after the output with the tile's column and row
    #[arg(long, value_parser = parse_tiles, default_value = "1x1")]
    tiles: (u32, u32),
    /// File to write
    #[arg(short, long)]
    output: PathBuf,
}

fn parse_tiles(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once('x').and_then(|(n, m)| Some((n.parse().ok()?, m.parse().ok()?)));
    parts.filter(|&(n, m)| n > 0 && m > 0).ok_or_else(|| "expected NxM, such as 4x4".to_string())
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("gen-lidar: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let survey = Survey::new(arguments.points, arguments.seed);
    let mut tiles = Tiles::create(arguments, survey.side)?;
    survey.fly(|record| tiles.put(record))?;
    let files = tiles.close()?;
    let Arguments { points, seed, output, .. } = arguments;
    eprintln!("gen-lidar: seed {seed}: wrote {points} points to {} ({files} files)", output.display());
    Ok(())
}

/// Uniform in [-1, 1).
fn signed(random: &mut Random) -> f64 {
    2.0 * random.unit() - 1.0
}

/// A range of hills: height, wave numbers and phase of a wave.
struct Wave {
    height: f64,
    along: [f64; 2],
    phase: f64,
}

/// The flight plan over a square.
struct Survey {
    points: u64,
    seed: u64,
    side: f64,
    lines: u64,
    swath_width: f64,
    terrain: Vec<Wave>,
}

/// A return of a laser pulse.
struct Return {
    position: [i32; 3],
    number: u8,
    of: u8,
    class: u8,
    angle: i8,
    line: u16,
    time: f64,
}

impl Survey {
    fn new(points: u64, seed: u64) -> Self {
        let side = (points.max(1) as f64 * (1.0 - OVERLAP) / DENSITY).sqrt();
        let swath_width = SWATH_WIDTH_MAX.min(side / (1.0 + (LINES_MIN - 1) as f64 * (1.0 - OVERLAP)));
        let lines = ((side - swath_width) / (swath_width * (1.0 - OVERLAP))).round() as u64 + 1;
        let mut random = Random::new(seed);
        let mut wave = |scale: f64| {
            let direction = random.unit() * TAU;
            let number = TAU / (scale * (0.7 + 0.6 * random.unit()));
            Wave {
                height: scale * 0.03,
                along: [number * direction.cos(), number * direction.sin()],
                phase: random.unit() * TAU,
            }
        };
        let terrain = [2000.0, 900.0, 400.0, 150.0, 60.0, 15.0].map(&mut wave).into();
        Survey { points, seed, side, lines, swath_width, terrain }
    }

    fn ground(&self, x: f64, y: f64) -> f64 {
        let wave = |wave: &Wave| wave.height * (wave.along[0] * x + wave.along[1] * y + wave.phase).sin();
        250.0 + self.terrain.iter().map(wave).sum::<f64>()
    }

    /// Passes all returns to a function, in the order of acquisition.
    fn fly(&self, mut put: impl FnMut(Return) -> Result<(), Failure>) -> Result<(), Failure> {
        for line in 0..self.lines {
            let share = self.points * (line + 1) / self.lines - self.points * line / self.lines;
            self.fly_line(line, share, &mut put)?;
        }
        Ok(())
    }

    /// Flies one line, north or south in turn, while the mirror swings from side to side.
    fn fly_line(
        &self,
        line: u64,
        points: u64,
        put: &mut impl FnMut(Return) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let mut random = Random::new(self.seed ^ (line + 1).wrapping_mul(0xd6e8_feb8_6659_fd93));
        let per_sweep = (points as f64 * self.swath_width / self.side).sqrt().max(1.0);
        let spacing = self.swath_width / per_sweep;
        let centre = self.swath_width * (0.5 + line as f64 * (1.0 - OVERLAP));
        let drift = random.unit() * TAU;
        let mut left = points;
        let mut pulse = 0.0;
        while left > 0 {
            let along = pulse / points as f64;
            let sweep = pulse / per_sweep;
            let swing = 2.0 * (sweep.fract() - 0.5);
            let across = if (sweep as u64).is_multiple_of(2) { swing } else { -swing };
            let wander = 0.02 * self.swath_width * (along * 5.0 + drift).sin();
            let x = centre + wander + 0.5 * self.swath_width * across + 0.2 * spacing * signed(&mut random);
            let north = if line.is_multiple_of(2) { along } else { 1.0 - along };
            let y = north * self.side + 0.2 * spacing * signed(&mut random);
            let ground = self.ground(x, y) + 0.03 * signed(&mut random);
            let canopy = ground + VEGETATION_HEIGHT * random.unit();
            let has_canopy = random.unit() < VEGETATION;
            let is_split = random.unit() < DUPLICATES && left > 1;
            let of = if is_split { 2 } else { 1 };
            let mut give = |number, z: f64, class| {
                left -= 1;
                let quantise = |value: f64| (value / SCALE).round() as i32;
                put(Return {
                    position: [quantise(ORIGIN[0] + x), quantise(ORIGIN[1] + y), quantise(z)],
                    number,
                    of,
                    class,
                    angle: (15.0 * across) as i8,
                    line: line as u16 + 1,
                    time: line as f64 * 600.0 + along * 300.0,
                })
            };
            if is_split {
                give(1, canopy, 5)?;
                give(2, ground, 2)?;
            } else if has_canopy {
                give(1, canopy, 5)?;
            } else {
                give(1, ground, 2)?;
            }
            // A split pulse gives two points, so it counts twice: the line then ends with its share of the
            // points.
            pulse += f64::from(of);
        }
        Ok(())
    }
}

/// A file being written.
struct Tile {
    writer: Writer<BufWriter<File>>,
    records: Vec<u8>,
    slab_len: usize,
}

impl Tile {
    fn create(path: &Path, slab_points: usize) -> Result<Tile, Failure> {
        let mut builder = Builder::from((1, 2));
        builder.point_format = Format::new(1)?;
        builder.point_format.is_compressed = path.extension().is_some_and(|ending| ending == "laz");
        let transform = |offset| las::Transform { scale: SCALE, offset };
        builder.transforms = las::Vector { x: transform(0.0), y: transform(0.0), z: transform(0.0) };
        builder.vlrs.push(geo_keys());
        let file = File::create(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let writer = Writer::new(BufWriter::with_capacity(1 << 20, file), builder.into_header()?)?;
        Ok(Tile { writer, records: Vec::new(), slab_len: slab_points * RECORD_LEN })
    }

    fn put(&mut self, r: &Return) -> Result<(), Failure> {
        for value in r.position {
            self.records.extend_from_slice(&value.to_le_bytes());
        }
        let intensity = 200 + u16::from(r.class) * 100;
        self.records.extend_from_slice(&intensity.to_le_bytes());
        self.records.extend_from_slice(&[r.number | r.of << 3, r.class, r.angle as u8, 0]);
        self.records.extend_from_slice(&r.line.to_le_bytes());
        self.records.extend_from_slice(&r.time.to_le_bytes());
        if self.records.len() >= self.slab_len { self.flush() } else { Ok(()) }
    }

    fn flush(&mut self) -> Result<(), Failure> {
        if self.records.is_empty() {
            return Ok(());
        }
        let records = std::mem::take(&mut self.records);
        let points = PointDataBuilder::new().for_header(self.writer.header()).build_from_bytes(records)?;
        self.writer.write_points(&points)?;
        Ok(())
    }
}

/// The GeoTIFF keys of a projected system.
fn geo_keys() -> Vlr {
    let keys: [u16; 16] = [1, 1, 0, 3, 1024, 0, 1, 1, 3072, 0, 1, EPSG, 3076, 0, 1, 9001];
    Vlr {
        user_id: "LASF_Projection".to_string(),
        record_id: 34735,
        description: "GeoTIFF keys".to_string(),
        data: keys.iter().flat_map(|key| key.to_le_bytes()).collect(),
    }
}

/// The files of a survey: half-open tiles of its square; the outer tiles are unbounded.
struct Tiles {
    tiles: Vec<Tile>,
    columns: u32,
    rows: u32,
    side: f64,
}

impl Tiles {
    fn create(arguments: &Arguments, side: f64) -> Result<Tiles, Failure> {
        let (columns, rows) = arguments.tiles;
        let output = &arguments.output;
        let stem = output.file_stem().unwrap_or_default().to_string_lossy();
        let ending = output.extension().unwrap_or_default().to_string_lossy();
        if !matches!(&*ending, "las" | "laz") {
            return Err(format!("{}: expected a name that ends with .laz or .las", output.display()).into());
        }
        let count = columns as usize * rows as usize;
        let mut tiles = Vec::with_capacity(count);
        for row in 0..rows {
            for column in 0..columns {
                let path = match count {
                    1 => output.clone(),
                    _ => output.with_file_name(format!("{stem}_{column}_{row}.{ending}")),
                };
                tiles.push(Tile::create(&path, (SLAB_POINTS / count).max(50_000))?);
            }
        }
        Ok(Tiles { tiles, columns, rows, side })
    }

    fn put(&mut self, record: Return) -> Result<(), Failure> {
        let index = |axis: usize, count: u32| {
            let place = f64::from(record.position[axis]) * SCALE - ORIGIN[axis];
            ((place / self.side * f64::from(count)) as u32).min(count - 1)
        };
        let tile = index(1, self.rows) * self.columns + index(0, self.columns);
        self.tiles[tile as usize].put(&record)
    }

    /// Finishes all files and returns their number.
    fn close(mut self) -> Result<usize, Failure> {
        for tile in &mut self.tiles {
            tile.flush()?;
            tile.writer.close()?;
        }
        Ok(self.tiles.len())
    }
}
