//! A map whose keys are ids that only grow.

/// Greatest number of entries of a block.
const BLOCK_LEN: usize = 512;

/// Up to this many blocks are not joined, however few entries they have.
const BLOCKS_MIN: usize = 16;

/// Ids of a block differ by less than this: twice the difference is a key of 32 bits.
const SPAN: u64 = 1 << 31;

/// The bit of a key whose entry is forgotten.
const FORGOTTEN: u32 = 1;

/// Values of ids that are added in increasing order, and forgotten in any order.
///
/// Entries are in the order of their ids, in blocks. A map that grows adds blocks and copies none, whereas a
/// hash table copies all its entries. Ids that are looked up in increasing order are found near each other.
///
/// Memory: 4 bytes and the value for each entry, and an eighth more, for entries that are forgotten.
#[derive(Debug)]
pub struct Ascending<T> {
    /// For each block, a lower bound of its ids, above all ids of the blocks before.
    firsts: Vec<u64>,
    blocks: Vec<Block<T>>,
    len: usize,
}

/// Entries in the order of their keys.
#[derive(Debug)]
struct Block<T> {
    /// Twice the difference of the id from the first of the block; odd if the entry is forgotten.
    keys: Vec<u32>,
    values: Vec<T>,
    forgotten: usize,
}

/// Where an entry is, until entries are forgotten.
#[derive(Debug, Clone, Copy, Default)]
pub struct Place {
    block: u32,
    entry: u32,
}

impl<T> Default for Ascending<T> {
    fn default() -> Self {
        Ascending { firsts: Vec::new(), blocks: Vec::new(), len: 0 }
    }
}

impl<T: Copy> Ascending<T> {
    /// Adds a value. Its id must be greater than all before.
    pub fn push(&mut self, id: u64, value: T) {
        let first = self.firsts.last().copied().unwrap_or_default();
        let has_room = |block: &Block<T>| block.keys.len() < BLOCK_LEN && id - first < SPAN;
        self.len += 1;
        if let Some(block) = self.blocks.last_mut().filter(|block| has_room(block)) {
            block.keys.push(((id - first) as u32) << 1);
            block.values.push(value);
            return;
        }
        let mut block = Block::with_capacity(BLOCK_LEN);
        block.keys.push(0);
        block.values.push(value);
        self.firsts.push(id);
        self.blocks.push(block);
    }

    /// Where the entry of `id` is. The search starts `near` another entry.
    pub fn find(&self, id: u64, near: Place) -> Option<Place> {
        let block = self.block_of(id, near.block as usize)?;
        let difference = id - self.firsts[block];
        let key = if difference < SPAN { (difference as u32) << 1 } else { return None };
        let keys = &self.blocks[block].keys;
        let entry = keys.partition_point(|&other| other < key);
        (keys.get(entry) == Some(&key)).then_some(Place { block: block as u32, entry: entry as u32 })
    }

    /// Finds the entries of several ids, which are found fast if they are near each other.
    ///
    /// # Errors
    /// The first id that has no entry.
    pub fn find_all(&self, ids: &[u64], places: &mut Vec<Place>) -> Result<(), u64> {
        places.clear();
        let mut near = Place::default();
        for &id in ids {
            near = self.find(id, near).ok_or(id)?;
            places.push(near);
        }
        Ok(())
    }

    /// The block that has `id`, if any has.
    fn block_of(&self, id: u64, near: usize) -> Option<usize> {
        let starts_after = |block: usize| self.firsts.get(block).is_none_or(|&first| id < first);
        if !starts_after(near) && starts_after(near + 1) {
            return Some(near);
        }
        self.firsts.partition_point(|&first| first <= id).checked_sub(1)
    }

    /// The value of an entry.
    pub fn at(&self, place: Place) -> &T {
        &self.blocks[place.block as usize].values[place.entry as usize]
    }

    /// The value of an entry.
    pub fn at_mut(&mut self, place: Place) -> &mut T {
        &mut self.blocks[place.block as usize].values[place.entry as usize]
    }

    /// The value of `id`.
    pub fn get(&self, id: u64) -> Option<&T> {
        self.find(id, Place::default()).map(|place| self.at(place))
    }

    /// Forgets entries. Places that were found before are not valid any more.
    pub fn forget(&mut self, places: &[Place]) {
        for place in places {
            let block = &mut self.blocks[place.block as usize];
            let key = &mut block.keys[place.entry as usize];
            let is_new = *key & FORGOTTEN == 0;
            *key |= FORGOTTEN;
            block.forgotten += usize::from(is_new);
            self.len -= usize::from(is_new);
        }
        for run in places.chunk_by(|one, next| one.block == next.block) {
            let block = &mut self.blocks[run[0].block as usize];
            if 8 * block.forgotten > block.keys.len() {
                block.give_back();
            }
        }
        if self.blocks.len() > BLOCKS_MIN + 4 * self.len / BLOCK_LEN {
            self.join_blocks();
        }
    }

    /// Joins neighbouring blocks that fit into one. Afterwards, two neighbours have more than [`BLOCK_LEN`]
    /// entries together, so many entries are added or forgotten before the next call.
    fn join_blocks(&mut self) {
        let firsts = std::mem::take(&mut self.firsts);
        let blocks = std::mem::take(&mut self.blocks);
        for (first, block) in firsts.into_iter().zip(blocks) {
            let Some(&last_key) = block.keys.last().filter(|_| block.len() > 0) else { continue };
            let before = self.firsts.last().zip(self.blocks.last_mut());
            let end = first + u64::from(last_key >> 1);
            match before.filter(|(start, to)| end - **start < SPAN && to.len() + block.len() <= BLOCK_LEN) {
                Some((start, to)) => to.append(block, ((first - start) as u32) << 1),
                None => {
                    self.firsts.push(first);
                    self.blocks.push(block);
                }
            }
        }
        self.blocks.iter_mut().for_each(Block::give_back);
    }

    /// Ids and values in the order of the ids.
    pub fn iter(&self) -> impl Iterator<Item = (u64, &T)> + '_ {
        self.firsts.iter().zip(&self.blocks).flat_map(|(first, block)| {
            block.entries().map(move |(key, value)| (first + u64::from(key >> 1), value))
        })
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there is no entry.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

impl<T: Copy> Block<T> {
    fn with_capacity(capacity: usize) -> Self {
        let (keys, values) = (Vec::with_capacity(capacity), Vec::with_capacity(capacity));
        Block { keys, values, forgotten: 0 }
    }

    /// Number of entries that are not forgotten.
    fn len(&self) -> usize {
        self.keys.len() - self.forgotten
    }

    fn entries(&self) -> impl Iterator<Item = (u32, &T)> + '_ {
        let all = self.keys.iter().copied().zip(&self.values);
        all.filter(|(key, _)| key & FORGOTTEN == 0)
    }

    /// Leaves out what is forgotten, and gives the room back.
    fn give_back(&mut self) {
        let mut kept = 0;
        for entry in 0..self.keys.len() {
            self.keys[kept] = self.keys[entry];
            self.values[kept] = self.values[entry];
            kept += usize::from(self.keys[entry] & FORGOTTEN == 0);
        }
        self.keys.truncate(kept);
        self.values.truncate(kept);
        self.keys.shrink_to_fit();
        self.values.shrink_to_fit();
        self.forgotten = 0;
    }

    /// Adds the entries of the next block, whose keys are greater by `shift` here.
    fn append(&mut self, next: Block<T>, shift: u32) {
        self.keys.extend(next.entries().map(|(key, _)| key + shift));
        self.values.extend(next.entries().map(|(_, value)| value));
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashMap;

    use super::*;
    use spmesh_base::random::Random;

    /// Ids in runs, with gaps of up to `gap` between runs.
    struct Ids {
        next: u64,
        run: u64,
        gap: u64,
    }

    impl Ids {
        fn next(&mut self, random: &mut Random) -> u64 {
            if self.run == 0 {
                self.run = 1 + random.below(300);
                self.next += random.below(self.gap);
            }
            self.run -= 1;
            self.next += 1;
            self.next
        }
    }

    /// A map of this library beside one of the standard library.
    #[derive(Default)]
    struct Pair {
        map: Ascending<u64>,
        reference: HashMap<u64, u64>,
        ids: Vec<u64>,
    }

    impl Pair {
        fn push(&mut self, id: u64, value: u64) {
            self.map.push(id, value);
            self.reference.insert(id, value);
            self.ids.push(id);
        }

        /// Forgets up to `count` ids, some of which are forgotten already, and one of them twice.
        fn forget(&mut self, count: u64, random: &mut Random) {
            if self.ids.is_empty() {
                return;
            }
            let is_old = random.below(2) == 0;
            let among = if is_old { self.ids.len().min(2000) } else { self.ids.len() } as u64;
            let mut gone: Vec<u64> = (0..count).map(|_| self.ids[random.below(among) as usize]).collect();
            if random.below(3) > 0 {
                gone.sort_unstable();
            }
            let mut near = Place::default();
            let mut places = Vec::new();
            for id in &gone {
                let found = self.map.find(*id, near);
                assert_eq!(found.map(|place| *self.map.at(place)), self.reference.get(id).copied());
                near = found.unwrap_or(near);
                places.extend(found);
            }
            for id in &gone {
                self.reference.remove(id);
            }
            self.ids.retain(|id| self.reference.contains_key(id) || id % 64 == 0);
            self.map.forget(&places);
        }

        fn check(&self) {
            assert_eq!(
                (self.map.len(), self.map.is_empty()),
                (self.reference.len(), self.reference.is_empty())
            );
            let found: Vec<(u64, u64)> = self.map.iter().map(|(id, &value)| (id, value)).collect();
            assert!(found.is_sorted_by(|one, next| one.0 < next.0));
            assert_eq!(found.len(), self.reference.len());
            assert!(found.iter().all(|(id, value)| self.reference.get(id) == Some(value)));
            // Blocks of ids that are too far apart are not joined.
            let (blocks, len) = (self.map.blocks.len(), self.map.len());
            let spans = self.map.firsts.last().map_or(0, |last| 2 * (last / SPAN) as usize);
            let most = 2 * BLOCKS_MIN + 4 * len / BLOCK_LEN + spans;
            assert!(blocks <= most, "{blocks} blocks of {len} entries, expected at most {most}");
        }
    }

    #[test]
    fn agrees_with_a_hash_map() {
        for seed in 0..8 {
            let random = &mut Random::new(seed);
            let gap = [1, 50, 1 << 20, 1 << 33][seed as usize % 4];
            let mut ids = Ids { next: 0, run: 0, gap };
            let mut pair = Pair::default();
            for step in 0..300 {
                // The map grows, stays about as large, and shrinks.
                let [pushed, forgotten] = [[400, 100], [100, 150], [20, 400]][step / 100];
                for _ in 0..random.below(pushed) {
                    let id = ids.next(random);
                    pair.push(id, random.bits());
                }
                pair.forget(random.below(forgotten), random);
                let id = random.below(ids.next + 10);
                assert_eq!(pair.map.get(id), pair.reference.get(&id));
                assert_eq!(pair.map.get(id << 20), pair.reference.get(&(id << 20)));
                // This looks at all of a map, which has hardly changed.
                if step % 4 == 0 {
                    pair.check();
                }
            }
        }
    }

    #[test]
    fn values_can_change() {
        let mut map = Ascending::default();
        (0..2000).for_each(|id| map.push(id, id));
        for id in 0..2000 {
            let place = map.find(id, Place::default()).unwrap();
            *map.at_mut(place) += 1;
        }
        assert!(map.iter().all(|(id, &value)| value == id + 1));
    }

    #[test]
    fn room_is_given_back() {
        let mut map = Ascending::default();
        for id in 0..1_000_000u64 {
            map.push(id, [id; 3]);
            if id >= 100 && id % 4096 != 4095 {
                let place = map.find(id - 100, Place::default());
                map.forget(place.as_slice());
            }
        }
        let room: usize = map.blocks.iter().map(|block| block.values.capacity()).sum();
        assert!(room < map.len() + map.len() / 4 + 2 * BLOCK_LEN, "{room} for {} entries", map.len());
    }
}
