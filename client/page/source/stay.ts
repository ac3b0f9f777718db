// Where the player stands: on the way in, playing, or out, and why. The reason comes as a line of text, of the server
// or the gateway (protocol/messages.cpp, client/client.cpp, client/gateway); a test compares this table with the
// server's.

export enum Stay {
  Connecting,
  Entering, // the gateway has answered: it calls the server, or the world is loading
  Playing,
  NoSuchWorld,
  Password, // the server asks for a password or an invite
  Full,
  Locked,
  Busy,
  NotAnswering,
  Closing,
  Silent,
  Lost,
  Kicked,
  Banned,
  TooManyFromAddress,
  OtherVersion,
  GatewayRefused,
  PoorLine,
  CutOff, // for what this page has sent, or not taken
  Refused, // for another reason, which is said
}

// What a reason begins with. What follows a colon is a detail for people.
const kReasons: [begin: string, stay: Stay][] = [
  ['server is full', Stay.Full],
  ['all places are taken', Stay.Full], // of the gateway
  ['the server is locked', Stay.Locked],
  ['server is busy', Stay.Busy],
  ['no answer from the server', Stay.NotAnswering],
  ['the server does not answer', Stay.NotAnswering], // the gateway
  ["the server's name is not known", Stay.NotAnswering],
  ['server is closing', Stay.Closing],
  ['server silent', Stay.Silent],
  ['the connection was lost', Stay.Lost],
  ['the server was restarted', Stay.Lost],
  ['the server has ended the connection', Stay.Lost],
  ['connection lost', Stay.Lost],
  ['removed by a moderator', Stay.Kicked],
  ['banned from this server', Stay.Banned],
  ['too many connections from this address', Stay.TooManyFromAddress],
  ['wrong protocol version', Stay.OtherVersion],
  ['wrong schema', Stay.OtherVersion],
  ['the password, invite or token', Stay.Password],
  ['the server does not know this gateway', Stay.GatewayRefused],
  ['connection too poor', Stay.PoorLine],
  ['no hello', Stay.CutOff],
  ['silent for too long', Stay.CutOff],
  ['too many bad messages', Stay.CutOff],
  ['too many messages', Stay.CutOff],
  ['sent too much', Stay.CutOff],
  ['reads too slowly', Stay.CutOff],
];

export function FindStayOf(reason: string): Stay {
  return kReasons.find(([begin]) => reason.startsWith(begin))?.[1] ?? Stay.Refused;
}

// What follows the first colon; empty: nothing.
export function FindDetail(reason: string): string {
  const at = reason.indexOf(': ');
  return at < 0 ? '' : reason.slice(at + 2);
}

// As Connection has it.
export interface Standing {
  isPlaying: boolean;
  isEntering: boolean; // the gateway has answered
  hasPlayed: boolean;
  lostReason: string; // empty: nothing was lost
  refused: string | null;
}

// missing: the world that the address names and this gateway does not have; empty: it has it. isOld: the gateway serves
// another page than this one by now.
export function FindStay(standing: Standing, missing: string, isOld: boolean): Stay {
  const { isPlaying, isEntering, hasPlayed, lostReason, refused } = standing;
  if (missing !== '') return Stay.NoSuchWorld;
  if (isPlaying) return Stay.Playing;
  if (refused !== null) return Stay.Password;
  if (lostReason === '') return isEntering ? Stay.Entering : Stay.Connecting;
  const stay = FindStayOf(lostReason);
  if (![Stay.Lost, Stay.NotAnswering, Stay.Silent].includes(stay)) return stay;
  if (isOld) return Stay.OtherVersion;
  return hasPlayed ? stay : Stay.NotAnswering; // nothing is lost that was not there
}
