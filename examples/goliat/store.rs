//! Results and checkpoints on disk: whole or not there, and never trusted without a look.
//!
//! A file is written under another name, brought to the disk and then renamed, so that a name stands for a whole file whenever the
//! program or the machine stops. It holds, little endian:
//!
//! ```text
//! "goliat 1" | length of the key: u64 | key | length of the content: u64 | content | checksum of all before: u64
//! ```
//!
//! The key is a text of everything that determines the content. A file of another key, of another length than it says, or of another checksum
//! is [`Found::Useless`], and its content is made again.

use std::fs::File;
use std::io::{BufReader, BufWriter, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use crate::Failure;

const MAGIC: &[u8; 8] = b"goliat 1";

/// A folder of files with one key.
pub(crate) struct Store {
    folder: PathBuf,
    key: String,
}

/// What a name stands for.
#[derive(Debug, PartialEq)]
pub(crate) enum Found {
    Nothing,
    /// And why.
    Useless(String),
    Content(Content),
}

impl Store {
    /// The folder `universes/<number of the key>` under `output`, made if missing, with the key in a text file for people.
    pub(crate) fn new(output: &Path, key: String) -> Result<Self, Failure> {
        let mut sum = Checksum::default();
        sum.add(key.as_bytes());
        let folder = output.join("universes").join(format!("{:016x}", sum.value()));
        let say = |error| format!("cannot write to {}: {error}", folder.display());
        std::fs::create_dir_all(&folder).map_err(say)?;
        std::fs::write(folder.join("settings.txt"), &key).map_err(say)?;
        Ok(Self { folder, key })
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    fn place(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file, whole or not at all. Its content is the parts, one after another.
    pub(crate) fn write(&self, name: &str, parts: &[Part<'_>]) -> Result<(), Failure> {
        let place = self.place(name);
        let say = |error| format!("cannot write {}: {error}", place.display());
        self.try_write(name, parts).map_err(|error| say(error).into())
    }

    fn try_write(&self, name: &str, parts: &[Part<'_>]) -> std::io::Result<()> {
        let place = self.place(name);
        let unfinished = self.place(&format!("{name}.unfinished"));
        let mut file =
            Summing { inner: BufWriter::new(File::create(&unfinished)?), sum: Checksum::default() };
        file.put(MAGIC)?;
        file.put(&(self.key.len() as u64).to_le_bytes())?;
        file.put(self.key.as_bytes())?;
        let length: usize = parts.iter().map(Part::length).sum();
        file.put(&(length as u64).to_le_bytes())?;
        for part in parts {
            match part {
                Part::Numbers(content) => file.put(&content.bytes)?,
                Part::Singles(numbers) => {
                    file.put(&(numbers.len() as u64).to_le_bytes())?;
                    for piece in numbers.chunks(1 << 14) {
                        file.put(
                            piece.iter().copied().flat_map(f32::to_le_bytes).collect::<Vec<_>>().as_slice(),
                        )?;
                    }
                }
            }
        }
        let sum = file.sum.value().to_le_bytes();
        file.put(&sum)?;
        file.inner.into_inner().map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
        std::fs::rename(unfinished, &place)?;
        // The name too must reach the disk; where folders cannot be opened (Windows), the system sees to it.
        File::open(&self.folder).map_or(Ok(()), |folder| folder.sync_all())
    }

    /// Looks for a file and checks all of it.
    pub(crate) fn read(&self, name: &str) -> Found {
        match self.try_read(name) {
            Ok(content) => Found::Content(content),
            Err(error) if error.kind() == ErrorKind::NotFound => Found::Nothing,
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                Found::Useless(String::from("it ends too early"))
            }
            Err(error) => Found::Useless(error.to_string()),
        }
    }

    fn try_read(&self, name: &str) -> std::io::Result<Content> {
        let file = File::open(self.place(name))?;
        let length = file.metadata()?.len();
        let mut file = Summing { inner: BufReader::new(file), sum: Checksum::default() };
        if file.get(8)? != MAGIC {
            return Err(wrong("it is not a file of this program"));
        }
        let left = |file: &Summing<_>| length.saturating_sub(file.sum.length);
        let key_length = file.number()?;
        if key_length > left(&file) {
            return Err(wrong("it ends too early"));
        }
        if file.get(key_length as usize)? != self.key.as_bytes() {
            return Err(wrong("it is of other settings"));
        }
        let content_length = file.number()?;
        if content_length.checked_add(8) != Some(left(&file)) {
            return Err(wrong("it has another length than it says"));
        }
        let content = file.get(content_length as usize)?;
        let sum = file.sum.value();
        if file.number()? != sum {
            return Err(wrong("its checksum is wrong"));
        }
        Ok(Content { bytes: content, at: 0 })
    }

    /// Removes a file, if it is there.
    pub(crate) fn remove(&self, name: &str) {
        // What cannot be removed is overwritten, or found useless, or harmless.
        let _ = std::fs::remove_file(self.place(name));
    }
}

fn wrong(what: &str) -> std::io::Error {
    std::io::Error::new(ErrorKind::InvalidData, what)
}

/// A file whose bytes are summed as they pass.
struct Summing<F> {
    inner: F,
    sum: Checksum,
}

impl<F: Write> Summing<F> {
    fn put(&mut self, bytes: &[u8]) -> std::io::Result<()> {
        self.sum.add(bytes);
        self.inner.write_all(bytes)
    }
}

impl<F: Read> Summing<F> {
    fn get(&mut self, length: usize) -> std::io::Result<Vec<u8>> {
        let mut bytes = vec![0; length];
        self.inner.read_exact(&mut bytes)?;
        self.sum.add(&bytes);
        Ok(bytes)
    }

    fn number(&mut self) -> std::io::Result<u64> {
        let bytes = self.get(8)?;
        Ok(u64::from_le_bytes(std::array::from_fn(|i| bytes[i])))
    }
}

/// FNV-1a over words of 8 bytes, with a rotation, for the high bits of a product do not reach the low ones. Against accidents, not malice.
#[derive(Clone, Copy)]
struct Checksum {
    state: u64,
    word: u64,
    length: u64,
}

impl Default for Checksum {
    fn default() -> Self {
        Self { state: 0xcbf2_9ce4_8422_2325, word: 0, length: 0 }
    }
}

impl Checksum {
    const PRIME: u64 = 0x0000_0100_0000_01b3;

    fn mix(state: u64, word: u64) -> u64 {
        (state ^ word).wrapping_mul(Self::PRIME).rotate_left(29)
    }

    fn add(&mut self, mut bytes: &[u8]) {
        while !self.length.is_multiple_of(8) || bytes.len() < 8 {
            let Some((&byte, rest)) = bytes.split_first() else { return };
            bytes = rest;
            self.word |= u64::from(byte) << (8 * (self.length % 8));
            self.length += 1;
            if self.length.is_multiple_of(8) {
                self.state = Self::mix(self.state, std::mem::take(&mut self.word));
            }
        }
        let (words, rest) = bytes.as_chunks::<8>();
        self.state = words.iter().fold(self.state, |state, word| Self::mix(state, u64::from_le_bytes(*word)));
        self.length += 8 * words.len() as u64;
        self.add(rest);
    }

    fn value(&self) -> u64 {
        let state = Self::mix(Self::mix(self.state, self.word), self.length);
        Self::mix(state, state >> 32)
    }
}

/// What a file's content is made of.
#[derive(Clone, Copy)]
pub(crate) enum Part<'a> {
    Numbers(&'a Content),
    /// As [`Content::put_singles`] has them, without a copy.
    Singles(&'a [f32]),
}

impl Part<'_> {
    fn length(&self) -> usize {
        match self {
            Self::Numbers(content) => content.bytes.len(),
            Self::Singles(numbers) => 8 + 4 * numbers.len(),
        }
    }
}

/// Numbers in a row, written and then read in the same order.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Content {
    bytes: Vec<u8>,
    at: usize,
}

impl Content {
    pub(crate) fn put(&mut self, number: u64) {
        self.bytes.extend(number.to_le_bytes());
    }

    pub(crate) fn put_real(&mut self, number: f64) {
        self.put(number.to_bits());
    }

    /// Their number first.
    pub(crate) fn put_reals(&mut self, numbers: &[f64]) {
        self.put(numbers.len() as u64);
        numbers.iter().for_each(|&number| self.put_real(number));
    }

    /// Their number first.
    pub(crate) fn put_singles(&mut self, numbers: &[f32]) {
        self.put(numbers.len() as u64);
        self.bytes.reserve_exact(4 * numbers.len());
        numbers.iter().for_each(|number| self.bytes.extend(number.to_le_bytes()));
    }

    fn take(&mut self, length: usize) -> Option<&[u8]> {
        let bytes = self.bytes.get(self.at..)?.get(..length)?;
        self.at += length;
        Some(bytes)
    }

    /// None where there is no more.
    pub(crate) fn get(&mut self) -> Option<u64> {
        self.take(8).map(|bytes| u64::from_le_bytes(std::array::from_fn(|i| bytes[i])))
    }

    pub(crate) fn get_real(&mut self) -> Option<f64> {
        self.get().map(f64::from_bits)
    }

    pub(crate) fn get_reals(&mut self) -> Option<Vec<f64>> {
        let length = usize::try_from(self.get()?).ok()?.checked_mul(8)?;
        let words = self.take(length)?.as_chunks::<8>().0;
        Some(words.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }

    pub(crate) fn get_singles(&mut self) -> Option<Vec<f32>> {
        let length = usize::try_from(self.get()?).ok()?.checked_mul(4)?;
        let words = self.take(length)?.as_chunks::<4>().0;
        Some(words.iter().map(|word| f32::from_le_bytes(*word)).collect())
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A folder of a test's own, empty.
    pub(crate) fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("goliat-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    }

    fn content() -> Content {
        let mut content = Content::default();
        content.put(7);
        content.put_reals(&[1.0, f64::NAN, -0.0]);
        content.put_singles(&[2.5, 1e-30, f32::MIN]);
        content
    }

    #[test]
    fn what_is_written_is_read() {
        let output = folder("read");
        let store = Store::new(&output, String::from("a key")).unwrap();
        assert_eq!(store.read("one"), Found::Nothing);
        let parts = [Part::Numbers(&content()), Part::Numbers(&content()), Part::Singles(&[0.5, -0.0])];
        store.write("one", &parts).unwrap();
        let Found::Content(mut read) = store.read("one") else { panic!() };
        for _ in 0..2 {
            assert_eq!(read.get(), Some(7));
            let reals = read.get_reals().unwrap();
            assert_eq!(
                reals.iter().map(|x| x.to_bits()).collect::<Vec<_>>(),
                [1.0, f64::NAN, -0.0].map(f64::to_bits)
            );
            assert_eq!(read.get_singles().unwrap(), [2.5, 1e-30, f32::MIN]);
        }
        assert_eq!(read.get_singles().unwrap(), [0.5, -0.0]);
        assert_eq!((read.get(), read.get_reals(), read.get_singles()), (None, None, None));
        store.remove("one");
        assert_eq!(store.read("one"), Found::Nothing);
        std::fs::remove_dir_all(output).unwrap();
    }

    #[test]
    fn a_file_cut_anywhere_or_changed_in_any_byte_is_useless() {
        let output = folder("damage");
        let store = Store::new(&output, String::from("a key")).unwrap();
        store.write("one", &[Part::Numbers(&content())]).unwrap();
        let place = store.place("one");
        let whole = std::fs::read(&place).unwrap();
        for end in 0..whole.len() {
            std::fs::write(&place, &whole[..end]).unwrap();
            assert!(matches!(store.read("one"), Found::Useless(_)), "cut at {end}");
            let mut changed = whole.clone();
            changed[end] ^= 1 << (end % 8);
            std::fs::write(&place, &changed).unwrap();
            assert!(matches!(store.read("one"), Found::Useless(_)), "changed at {end}");
        }
        let longer = [&whole[..], &[0]].concat();
        std::fs::write(&place, longer).unwrap();
        assert!(matches!(store.read("one"), Found::Useless(_)));
        std::fs::remove_dir_all(output).unwrap();
    }

    #[test]
    fn files_of_other_settings_are_useless_and_lie_elsewhere() {
        let output = folder("settings");
        let [one, two] = ["a key", "b key"].map(|key| Store::new(&output, String::from(key)).unwrap());
        assert_ne!(one.folder(), two.folder());
        one.write("one", &[Part::Numbers(&content())]).unwrap();
        std::fs::copy(one.place("one"), two.place("one")).unwrap();
        assert_eq!(two.read("one"), Found::Useless(String::from("it is of other settings")));
        std::fs::remove_dir_all(output).unwrap();
    }

    #[test]
    fn a_file_left_unfinished_is_not_a_file() {
        let output = folder("unfinished");
        let store = Store::new(&output, String::from("a key")).unwrap();
        std::fs::write(store.place("one.unfinished"), b"goliat 1").unwrap();
        assert_eq!(store.read("one"), Found::Nothing);
        std::fs::remove_dir_all(output).unwrap();
    }

    #[test]
    fn a_sum_does_not_depend_on_how_bytes_are_cut() {
        let bytes: Vec<u8> = (0..100).collect();
        let sum = |cuts: &[usize]| {
            let (mut sum, mut from) = (Checksum::default(), 0);
            for &cut in cuts.iter().chain([&bytes.len()]) {
                sum.add(&bytes[from..cut]);
                from = cut;
            }
            sum.value()
        };
        assert!([&[1, 2, 3][..], &[8, 9, 50], &[7, 7, 99]].iter().all(|cuts| sum(cuts) == sum(&[])));
    }
}
