// SPDX-License-Identifier: MIT
// The worker of the player: it plays the recording of a static folder to the viewer in this page,
// by the messages of the protocol (client/web/recorded_server.hpp). It receives `open`, then the
// viewer's messages as bytes. It sends messages as bytes, `open`, `share`, `failed` and `problem`.
import {startCore} from './core.js';
import {openFile} from './remote_file.js';

const kMostAtOnce = 50;  // messages of a poll; others wait for the next one

let core = null;
let file = null;

onmessage = async ({data}) => {
  if (data instanceof Uint8Array) return receive(data);
  try {
    file = await openFile(data.url, (share) => postMessage({type: 'share', share}));
    core = await startCore(data.module, file);
    if (!core.e.playOpen())
      throw new Error(file.failure || `the recording ${core.text(core.e.outputSize())}`);
  } catch (error) {
    return postMessage({type: 'failed', text: error.message});
  }
  postMessage({type: 'open'});
  setInterval(play, 2);
};

function receive(bytes) {
  core.put(bytes);
  core.e.playReceive(performance.now());
  play();
}

function play() {
  for (let i = 0; i < kMostAtOnce; ++i) {
    const size = core.e.playPoll(performance.now());
    if (size === 0) break;
    const bytes = core.output(size);
    postMessage(bytes, [bytes.buffer]);
  }
  reportProblem();
}

let reported = '';
function reportProblem() {
  const size = core.e.playProblem();
  const problem = file.failure || (size > 0 ? `the recording ${core.text(size)}` : '');
  if (problem === reported) return;
  reported = problem;
  postMessage({type: 'problem', text: problem});
}
