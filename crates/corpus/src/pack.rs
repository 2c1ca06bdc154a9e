//! Shards: the bytes of many clips in files of a limited size.

/// The greatest size of a shard, bytes. A clip that is larger has one of its own.
pub const SHARD_BYTES: usize = 64 << 20;

/// The place of some bytes in the shards.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Slot {
    /// The number of the shard.
    pub shard: usize,
    /// The first byte.
    pub offset: usize,
    /// The number of bytes.
    pub length: usize,
}

/// Bytes of a shard, which lie in a record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// The key of the record.
    pub key: String,
    /// The number of the clip in the record.
    pub clip: usize,
}

/// Finds places for bytes, one after the other.
#[derive(Debug, Default)]
pub(crate) struct Placer(Slot);

impl Placer {
    /// Returns the place of some bytes; `None` if there are none.
    pub(crate) fn add(&mut self, length: usize) -> Option<Slot> {
        if length == 0 {
            return None;
        }
        let next = &mut self.0;
        if next.offset > 0 && next.offset.saturating_add(length) > SHARD_BYTES {
            *next = Slot { shard: next.shard + 1, ..Slot::default() };
        }
        let slot = Slot { length, ..*next };
        next.offset = next.offset.saturating_add(length);
        Some(slot)
    }
}

/// Places bytes one after the other, and records the clips of each shard.
#[derive(Debug, Default)]
pub(crate) struct Packer {
    placer: Placer,
    shards: Vec<Vec<Piece>>,
}

impl Packer {
    /// Places bytes; `None` if there are none.
    pub(crate) fn add(&mut self, piece: Piece, length: usize) -> Option<Slot> {
        let slot = self.placer.add(length)?;
        if self.shards.len() <= slot.shard {
            self.shards.push(Vec::new());
        }
        if let Some(last) = self.shards.last_mut() {
            last.push(piece);
        }
        Some(slot)
    }

    /// Returns the pieces of each shard, in order.
    pub(crate) fn finish(self) -> Vec<Vec<Piece>> {
        self.shards
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_bytes_fill_shards_up_to_their_limit() {
        let mut packer = Packer::default();
        let piece = |clip| Piece { key: "a".into(), clip };
        let sizes = [SHARD_BYTES - 1, 1, 0, 2, SHARD_BYTES + 7, 3];
        let slots: Vec<_> =
            sizes.iter().enumerate().map(|(clip, size)| packer.add(piece(clip), *size)).collect();
        let at = |shard, offset, length| Some(Slot { shard, offset, length });
        assert_eq!(
            slots,
            [
                at(0, 0, SHARD_BYTES - 1),
                at(0, SHARD_BYTES - 1, 1),
                None,
                at(1, 0, 2),
                at(2, 0, SHARD_BYTES + 7),
                at(3, 0, 3),
            ]
        );
        let clips = |pieces: &Vec<Piece>| pieces.iter().map(|piece| piece.clip).collect::<Vec<_>>();
        let shards: Vec<_> = packer.finish().iter().map(clips).collect();
        assert_eq!(shards, [vec![0, 1], vec![3], vec![4], vec![5]]);
    }
}
