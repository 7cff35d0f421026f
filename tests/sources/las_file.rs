//! Writes small LAS files according to the standard, independently of the reader.

use std::io::Cursor;

/// The parts of a file that tests vary.
#[derive(Clone)]
pub struct LasFile {
    pub scale: [f64; 3],
    pub offset: [f64; 3],
    pub format: u8,
    pub records: Vec<Record>,
    /// VLRs of "LASF_Projection": record id and content.
    pub projection: Vec<(u16, Vec<u8>)>,
}

/// The fields of a point that tests vary.
#[derive(Clone, Copy, Default)]
pub struct Record {
    pub position: [i32; 3],
    pub class: u8,
    pub number: u8,
    pub of: u8,
    /// The bits of the class flags: synthetic, key point, withheld, overlap.
    pub flags: u8,
    pub intensity: u16,
    pub user_data: u8,
    pub point_source: u16,
    pub gps_time: f64,
}

impl LasFile {
    /// Format 1 with a scale of 0.01; all points are single returns of class 2.
    pub fn of(positions: &[[i32; 3]]) -> LasFile {
        let record =
            |&position: &[i32; 3]| Record { position, class: 2, number: 1, of: 1, ..Record::default() };
        LasFile {
            scale: [0.01; 3],
            offset: [0.0; 3],
            format: 1,
            records: positions.iter().map(record).collect(),
            projection: Vec::new(),
        }
    }

    /// LAS 1.2 for formats up to 5, LAS 1.4 above.
    pub fn bytes(&self) -> Vec<u8> {
        let is_extended = self.format >= 6;
        let header_len: u16 = if is_extended { 375 } else { 227 };
        let record_len = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67][usize::from(self.format)];
        let vlrs = self.vlrs();
        let count = self.records.len() as u32;
        let mut bytes = vec![0; 24];
        bytes[..4].copy_from_slice(b"LASF");
        bytes.extend([1, if is_extended { 4 } else { 2 }]);
        bytes.resize(94, 0);
        bytes.extend(header_len.to_le_bytes());
        bytes.extend((u32::from(header_len) + vlrs.len() as u32).to_le_bytes());
        bytes.extend((self.projection.len() as u32).to_le_bytes());
        bytes.push(self.format);
        bytes.extend((record_len as u16).to_le_bytes());
        bytes.extend(if is_extended { 0 } else { count }.to_le_bytes());
        bytes.resize(131, 0);
        let bounds = self.world_bounds();
        for value in self.scale.iter().chain(&self.offset).chain(&bounds) {
            bytes.extend(value.to_le_bytes());
        }
        bytes.resize(usize::from(header_len), 0);
        if is_extended {
            bytes[247..255].copy_from_slice(&u64::from(count).to_le_bytes());
        }
        bytes.extend(vlrs);
        for record in &self.records {
            bytes.extend(record.bytes(is_extended, record_len));
        }
        bytes
    }

    /// The same as LAZ, with a chunk table, in chunks of `chunk` points.
    pub fn compressed(&self, chunk: u32) -> Vec<u8> {
        let mut bytes = self.bytes();
        let vlr = laz::LazVlrBuilder::default()
            .with_point_format(self.format, 0)
            .expect("a format")
            .with_fixed_chunk_size(chunk)
            .build();
        let mut content = Cursor::new(Vec::new());
        vlr.write_to(&mut content).expect("written to memory");
        let content = content.into_inner();
        let start = u32::from_le_bytes(bytes[96..100].try_into().expect("four bytes")) as usize;
        let records = bytes.split_off(start);
        bytes.extend([0, 0]);
        bytes.extend(b"laszip encoded\0\0");
        bytes.extend(22204u16.to_le_bytes());
        bytes.extend((content.len() as u16).to_le_bytes());
        bytes.extend([0; 32]);
        bytes.extend(content);
        let start = bytes.len() as u32;
        bytes[96..100].copy_from_slice(&start.to_le_bytes());
        bytes[100..104].copy_from_slice(&(self.projection.len() as u32 + 1).to_le_bytes());
        bytes[104] |= 0x80;
        let mut file = Cursor::new(bytes);
        file.set_position(start.into());
        let mut compressor = laz::LasZipCompressor::new(&mut file, vlr).expect("a compressor");
        compressor.compress_many(&records).expect("compressed");
        compressor.done().expect("the chunk table is written");
        drop(compressor);
        file.into_inner()
    }

    fn vlrs(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (number, content) in &self.projection {
            bytes.extend([0, 0]);
            bytes.extend(b"LASF_Projection\0");
            bytes.extend(number.to_le_bytes());
            bytes.extend((content.len() as u16).to_le_bytes());
            bytes.extend([0; 32]);
            bytes.extend(content);
        }
        bytes
    }

    /// Greatest and smallest world coordinate per axis, in the header's order.
    fn world_bounds(&self) -> [f64; 6] {
        std::array::from_fn(|i| {
            let axis = i / 2;
            let values = self.records.iter().map(|record| record.position[axis]);
            let value = if i % 2 == 0 { values.max() } else { values.min() };
            f64::from(value.unwrap_or(0)) * self.scale[axis] + self.offset[axis]
        })
    }
}

impl Record {
    fn bytes(&self, is_extended: bool, record_len: usize) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.position.iter().flat_map(|value| value.to_le_bytes()).collect();
        bytes.extend(self.intensity.to_le_bytes());
        if is_extended {
            bytes.extend([self.number | self.of << 4, self.flags, self.class, self.user_data, 0, 0]);
        } else {
            bytes.extend([self.number | self.of << 3, self.class | self.flags << 5, 0, self.user_data]);
        }
        bytes.extend(self.point_source.to_le_bytes());
        bytes.extend(self.gps_time.to_le_bytes());
        bytes.resize(record_len, 0);
        bytes
    }
}

/// GeoTIFF keys of a projected coordinate system.
pub fn geo_keys(epsg: u16) -> (u16, Vec<u8>) {
    let keys: [u16; 8] = [1, 1, 0, 1, 3072, 0, 1, epsg];
    (34735, keys.iter().flat_map(|key| key.to_le_bytes()).collect())
}
