//! The messages of a file, one after another, in bounded memory. The crate `mcap` has readers of messages too; they
//! panic at an attachment that is too short, and unpack chunks with libraries in C.

use crate::error::LogError;
use crate::fields::Fields;
use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::{LinearReadEvent, LinearReader, LinearReaderOptions};
use std::collections::{BTreeMap, HashMap};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Most bytes of a record, and of an unpacked chunk.
const MOST: usize = 256 << 20;
/// Bytes that are read at once: a length is believed as far as bytes follow.
const AT_ONCE: usize = 1 << 16;

/// What all messages of a topic have in common.
#[derive(Debug)]
pub(crate) struct Channel {
    pub(crate) topic: String,
    pub(crate) encoding: String,
    pub(crate) metadata: BTreeMap<String, String>,
    pub(crate) schema: Option<Arc<Schema>>,
}

#[derive(Debug)]
pub(crate) struct Schema {
    pub(crate) name: String,
    pub(crate) encoding: String,
    pub(crate) data: Vec<u8>,
}

#[derive(Debug)]
pub(crate) struct Message {
    pub(crate) channel: Arc<Channel>,
    pub(crate) sequence: u32,
    /// Nanoseconds.
    pub(crate) log_time: u64,
    pub(crate) publish_time: u64,
    pub(crate) data: Vec<u8>,
}

/// Whether messages of a channel are wanted, if the user names this topic.
pub(crate) type Wanted = fn(&Channel, Option<&str>) -> bool;

pub(crate) struct Messages {
    path: PathBuf,
    source: File,
    reader: LinearReader,
    channels: Channels,
    chunk: Vec<u8>,
    /// Number of bytes of the chunk that are taken.
    taken: usize,
    /// Whether the end of the file is missing.
    pub(crate) is_cut: bool,
}

impl Messages {
    pub(crate) fn open(path: &Path, wanted: Wanted, topic: Option<&str>) -> Result<Self, LogError> {
        let source = File::open(path).map_err(|source| LogError::Read {
            path: path.to_owned(),
            source,
        })?;
        let options = LinearReaderOptions::default()
            .with_emit_chunks(true)
            .with_record_length_limit(MOST);
        Ok(Self {
            path: path.to_owned(),
            source,
            reader: LinearReader::new_with_options(options),
            channels: Channels {
                schemas: HashMap::new(),
                known: BTreeMap::new(),
                wanted,
                topic: topic.map(str::to_owned),
                time: 0,
            },
            chunk: Vec::new(),
            taken: 0,
            is_cut: false,
        })
    }

    /// The channels so far, with the number of their messages.
    pub(crate) fn channels(&self) -> impl Iterator<Item = (&Channel, u64)> {
        self.channels
            .known
            .values()
            .map(|(channel, count)| (&**channel, *count))
    }

    /// The log time of the last message so far, wanted or not, nanoseconds.
    pub(crate) fn time(&self) -> u64 {
        self.channels.time
    }

    /// The next wanted message; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Message>, LogError> {
        loop {
            match self.step() {
                Ok(Step::On) => {}
                Ok(Step::Message(message)) => return Ok(Some(message)),
                Ok(Step::End) => return Ok(None),
                Err(problem) => {
                    let (file, time) = (self.path.display(), seconds(self.time()));
                    return Err(LogError::at(format!("{file}, after {time} s"), problem));
                }
            }
        }
    }

    fn step(&mut self) -> Result<Step, String> {
        if self.taken < self.chunk.len() {
            let mut rest = Fields(&self.chunk[self.taken..]);
            let (opcode, data) = rest.record().ok_or("a record goes beyond the end of its chunk")?;
            self.taken = self.chunk.len() - rest.0.len();
            return self.channels.take(opcode, data);
        }
        match self.reader.next_event() {
            None => Ok(Step::End),
            Some(Ok(LinearReadEvent::ReadRequest(wanted))) => {
                let buffer = self.reader.insert(wanted.min(AT_ONCE));
                let read = loop {
                    match self.source.read(buffer) {
                        Err(error) if error.kind() == ErrorKind::Interrupted => {}
                        read => break read.map_err(|error| error.to_string())?,
                    }
                };
                self.reader.notify_read(read);
                Ok(Step::On)
            }
            Some(Ok(LinearReadEvent::Record { opcode, data })) => match opcode {
                op::DATA_END => Ok(Step::End),
                op::CHUNK => {
                    (self.chunk, self.taken) = (unpacked(data)?, 0);
                    Ok(Step::On)
                }
                _ => self.channels.take(opcode, data),
            },
            Some(Err(McapError::UnexpectedEof)) => {
                self.is_cut = true;
                Ok(Step::End)
            }
            Some(Err(McapError::BadMagic)) => Err("the file is not MCAP".to_owned()),
            Some(Err(error)) => Err(error.to_string()),
        }
    }
}

enum Step {
    On,
    Message(Message),
    End,
}

/// The channels so far, with the number of their messages.
struct Channels {
    schemas: HashMap<u16, Arc<Schema>>,
    known: BTreeMap<u16, (Arc<Channel>, u64)>,
    wanted: Wanted,
    topic: Option<String>,
    time: u64,
}

impl Channels {
    /// Takes a record.
    fn take(&mut self, opcode: u8, data: &[u8]) -> Result<Step, String> {
        let mut fields = Fields(data);
        let short = |what: &str| format!("a record of a {what} ends early, or its text is not UTF-8");
        match opcode {
            op::SCHEMA => {
                let (id, schema) = fields.schema().ok_or_else(|| short("schema"))?;
                self.schemas.insert(id, schema.into());
            }
            op::CHANNEL => {
                let (id, channel) = fields.channel(&self.schemas).ok_or_else(|| short("channel"))?;
                self.known.entry(id).or_insert((channel.into(), 0));
            }
            op::MESSAGE => {
                let (id, head) = fields.message_head().ok_or_else(|| short("message"))?;
                let known = self.known.get_mut(&id);
                let (channel, count) = known.ok_or_else(|| format!("a message of channel {id}, which is unknown"))?;
                let (sequence, log_time, publish_time) = head;
                *count += 1;
                self.time = log_time;
                if (self.wanted)(channel, self.topic.as_deref()) {
                    return Ok(Step::Message(Message {
                        channel: Arc::clone(channel),
                        sequence,
                        log_time,
                        publish_time,
                        data: fields.0.to_owned(),
                    }));
                }
            }
            _ => {}
        }
        Ok(Step::On)
    }
}

impl<'a> Fields<'a> {
    fn record(&mut self) -> Option<(u8, &'a [u8])> {
        let (opcode, length) = (self.u8()?, self.u64()?);
        Some((opcode, self.bytes(length)?))
    }

    fn schema(&mut self) -> Option<(u16, Schema)> {
        let schema = |name, encoding, data: &[u8]| Schema {
            name,
            encoding,
            data: data.to_owned(),
        };
        Some((self.u16()?, schema(self.text()?, self.text()?, self.counted()?)))
    }

    fn channel(&mut self, schemas: &HashMap<u16, Arc<Schema>>) -> Option<(u16, Channel)> {
        let (id, schema) = (self.u16()?, self.u16()?);
        let channel = Channel {
            topic: self.text()?,
            encoding: self.text()?,
            metadata: self.texts()?,
            schema: schemas.get(&schema).cloned(),
        };
        Some((id, channel))
    }

    /// The channel; the sequence, the log time and the time of publication.
    fn message_head(&mut self) -> Option<(u16, (u32, u64, u64))> {
        Some((self.u16()?, (self.u32()?, self.u64()?, self.u64()?)))
    }
}

/// The records of a chunk.
fn unpacked(chunk: &[u8]) -> Result<Vec<u8>, String> {
    let (size, checksum, compression, packed) = chunk_fields(chunk).ok_or("a chunk ends early")?;
    let of_decoder = |error: &dyn std::fmt::Display| format!("a chunk of {compression} is damaged: {error}");
    let mut records = Vec::new();
    let read = match compression.as_str() {
        "" => Box::new(packed) as Box<dyn Read>,
        "zstd" => Box::new(ruzstd::decoding::StreamingDecoder::new(packed).map_err(|error| of_decoder(&error))?),
        "lz4" => Box::new(lz4_flex::frame::FrameDecoder::new(packed)),
        _ => return Err(format!("chunks of compression {compression:?}; zstd and lz4 are read")),
    };
    // One byte more shows that there are more.
    read.take(MOST as u64 + 1)
        .read_to_end(&mut records)
        .map_err(|error| of_decoder(&error))?;
    if records.len() as u64 != size || records.len() > MOST {
        return Err(format!("a chunk of {} bytes, stated are {size}", records.len()));
    }
    if checksum != 0 && crc32fast::hash(&records) != checksum {
        return Err("a chunk is damaged: its checksum is wrong".to_owned());
    }
    Ok(records)
}

/// Size and checksum of the records, their compression, and their packed bytes.
fn chunk_fields(chunk: &[u8]) -> Option<(u64, u32, String, &[u8])> {
    let mut fields = Fields(chunk);
    let _times = (fields.u64()?, fields.u64()?);
    let (size, checksum, compression) = (fields.u64()?, fields.u32()?, fields.text()?);
    let length = fields.u64()?;
    Some((size, checksum, compression, fields.bytes(length)?))
}

/// Nanoseconds in words.
pub(crate) fn seconds(nanoseconds: u64) -> String {
    format!("{}.{:06}", nanoseconds / 1_000_000_000, nanoseconds / 1000 % 1_000_000)
}
