// Finds hands in the camera's picture and sends their landmarks to the program on this machine.
// The picture itself goes nowhere: it is drawn in this page, and read by the engine in this page.
const token = encodeURIComponent(new URLSearchParams(location.search).get("token") ?? "");
const ours = (name) => `/${name}?token=${token}`;

const line = document.getElementById("line");
const video = document.getElementById("video");
const canvas = document.getElementById("marks");
const mirroredBox = document.getElementById("mirrored");
const again = document.getElementById("again");
const speed = document.getElementById("speed");
const marker = document.getElementById("marks-corners");

/** Shows the one line that the person reads; `well` if hands are followed. */
function tell(text, well = false) {
  if (line.textContent !== text) line.textContent = text;
  line.classList.toggle("well", well);
}

// One finger after another: places in the list of landmarks.
const FINGERS = [
  [0, 1, 2, 3, 4],
  [0, 5, 6, 7, 8],
  [5, 9, 10, 11, 12],
  [9, 13, 14, 15, 16],
  [13, 17, 18, 19, 20],
  [0, 17],
];
const WRONG_HAND_AFTER = 3000; // ms of nothing but the other hand
const SLOW_AFTER = 30; // pictures over which the speed is told

let wanted = { sides: ["right"], hands: 3 };
let socket = null;
let landmarker = null;
let wrongSince = null;
let over = false;
let marking = null; // corners that were marked so far
let corners = [];
const took = [];

function connect() {
  return new Promise((resolve, reject) => {
    socket = new WebSocket(`ws://${location.host}/landmarks?token=${token}`);
    socket.onmessage = (event) => {
      const said = JSON.parse(event.data);
      if (said.what === "wanted") {
        wanted = said;
        mirroredBox.checked = said.mirrored;
        marker.hidden = !said.marks;
        // A camera over a tablet does not face the person: no mirror is expected.
        document.body.classList.toggle("over", said.marks === true);
        resolve();
      } else if (said.what === "bye") {
        end(said.why);
      }
    };
    socket.onclose = () => {
      end("The program has ended. This page can be closed.");
      reject(new Error("closed"));
    };
  });
}

/** Ends for good: the camera goes off. */
function end(why) {
  if (over) return;
  over = true;
  for (const track of video.srcObject?.getTracks() ?? []) track.stop();
  document.getElementById("on").hidden = true;
  canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
  tell(why);
}

function send(message) {
  if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

/** Tells the person and the program why there is no picture. */
function trouble(kind, text) {
  tell(text);
  send({ trouble: kind });
  again.hidden = false;
}

const WORDS = {
  NotFoundError: ["absent", "No camera is connected to this machine. Connect one, then try again."],
  OverconstrainedError: ["absent", "No camera here has such a picture. Connect another one."],
  NotReadableError: ["in use", "Another program uses the camera. Close it, then try again."],
  AbortError: ["in use", "The camera does not start. Close what may use it, then try again."],
  NotAllowedError: [
    "refused",
    "The browser does not let this page see the camera. Allow it beside the address, then try again.",
  ],
};

async function openCamera() {
  again.hidden = true;
  tell("Asking for the camera ...");
  if (!navigator.mediaDevices?.getUserMedia) {
    trouble("refused", "This browser gives no camera to this page. Open the link on 127.0.0.1.");
    return false;
  }
  try {
    const stream = await navigator.mediaDevices.getUserMedia({
      audio: false,
      video: { width: { ideal: 640 }, height: { ideal: 480 }, frameRate: { ideal: 30 } },
    });
    stream.getVideoTracks()[0].onended = () =>
      trouble("absent", "The camera has gone. Connect it, then try again.");
    video.srcObject = stream;
    await video.play();
  } catch (error) {
    const [kind, text] = WORDS[error.name] ?? ["absent", `The camera gives no picture: ${error}`];
    trouble(kind, text);
    return false;
  }
  document.getElementById("on").hidden = false;
  tell("Loading what finds hands ...");
  return true;
}

async function openEngine() {
  const { FilesetResolver, HandLandmarker } = await import(ours("engine/vision_bundle.mjs"));
  const simd = await FilesetResolver.isSimdSupported();
  const name = simd ? "vision_wasm_internal" : "vision_wasm_nosimd_internal";
  landmarker = await HandLandmarker.createFromOptions(
    {
      wasmLoaderPath: ours(`engine/wasm/${name}.js`),
      wasmBinaryPath: ours(`engine/wasm/${name}.wasm`),
    },
    {
      baseOptions: { modelAssetPath: ours("engine/hand_landmarker.task"), delegate: "CPU" },
      runningMode: "VIDEO",
      numHands: wanted.hands,
    },
  );
}

/** A rounded number; null for one that is not finite. */
const round = (x, digits) => (Number.isFinite(x) ? Number(x.toFixed(digits)) : null);

/** Coordinates of a point; NaN for those that the engine does not know. */
const coordinates = (p) => [p?.x ?? NaN, p?.y ?? NaN, p?.z ?? NaN];

/** Landmarks of a hand as they are sent, null where the engine does not know them; those of a mirrored picture are turned back. */
function hand(found, i, width, height) {
  const flip = mirroredBox.checked;
  const [most] = found.handedness?.[i] ?? [];
  const name = most ? (most.categoryName === "Right" ? "right" : "left") : null;
  const other = name && (name === "right" ? "left" : "right");
  return {
    side: flip ? other : name,
    score: most ? round(Math.min(most.score, 1), 4) : null,
    image:
      found.landmarks[i]?.map(coordinates).map(([x, y]) => [
        round((flip ? 1 - x : x) * width, 2),
        round(y * height, 2),
      ]) ?? null,
    world:
      found.worldLandmarks?.[i]?.map(coordinates).map(([x, y, z]) => [
        round(flip ? -x : x, 5),
        round(y, 5),
        round(z, 5),
      ]) ?? null,
  };
}

/** True for a hand of which the engine knows side and places. */
const known = (h) =>
  h.side !== null && [h.image, h.world].every((places) => places?.flat().every(Number.isFinite));

function draw(found) {
  const { videoWidth: width, videoHeight: height } = video;
  canvas.width = width;
  canvas.height = height;
  const pen = canvas.getContext("2d");
  pen.lineWidth = Math.max(2, width / 200);
  pen.strokeStyle = "#5fc38a";
  for (const points of found.landmarks)
    for (const finger of points ? FINGERS : []) {
      pen.beginPath();
      for (const i of finger) {
        const [x, y] = coordinates(points[i]);
        pen.lineTo(x * width, y * height); // the canvas leaves out what is not finite
      }
      pen.stroke();
    }
  const marks = marking ?? corners;
  pen.strokeStyle = "#f2b84b";
  pen.beginPath();
  for (const [x, y] of marks) pen.lineTo(x, y);
  if (marks.length === 4) pen.closePath();
  pen.stroke();
  for (const [x, y] of marks) pen.strokeRect(x - 4, y - 4, 8, 8);
}

const CORNERS = ["top left", "top right", "bottom right", "bottom left"];

/** Asks for the next corner of the tablet, as the person who sits at it calls it. */
function askCorner() {
  tell(`Click the tablet's ${CORNERS[marking.length]} corner, as you see it when you sit before it.`);
}

marker.onclick = () => {
  marking = [];
  askCorner();
};

canvas.onclick = (event) => {
  if (marking === null) return;
  const box = canvas.getBoundingClientRect();
  const x = ((event.clientX - box.left) / box.width) * canvas.width;
  const y = ((event.clientY - box.top) / box.height) * canvas.height;
  marking.push([round(x, 1), round(y, 1)]);
  if (marking.length < CORNERS.length) return askCorner();
  [corners, marking] = [marking, null];
  const unmirrored = corners.map(([a, b]) => [
    round(mirroredBox.checked ? canvas.width - a : a, 1),
    b,
  ]);
  send({ corners: unmirrored });
  tell("The corners are marked.", true);
};

/** The one line about what is in the picture. */
function judge(hands, now) {
  if (marking !== null) return;
  const sides = hands.map((h) => h.side);
  const followed = wanted.sides.filter((side) => sides.includes(side));
  if (hands.length && !followed.length) wrongSince ??= now;
  else wrongSince = null;
  if (!hands.length) {
    tell(`No hand is seen. Hold your ${wanted.sides.join(" and ")} hand before the camera.`);
  } else if (hands.length > wanted.most) {
    tell(`${hands.length} hands are seen. One person at a time: the others step back.`);
  } else if (wrongSince !== null && now - wrongSince > WRONG_HAND_AFTER) {
    tell(
      `A ${sides[0]} hand is seen, and the ${wanted.sides[0]} one is asked for. ` +
        "If it is that, tick that the camera mirrors its picture.",
    );
  } else if (followed.length < wanted.sides.length) {
    tell(`Only the ${followed[0] ?? "other"} hand is seen.`);
  } else {
    tell("Your hand is followed.", true);
  }
}

let last = -1;
let awaited = 0; // the browser's number of the next look

/** True while the camera is there. Its last picture may come after it was pulled out. */
const live = () => video.srcObject?.getVideoTracks()[0]?.readyState === "live";

function look(now, data) {
  if (over || !live()) return;
  try {
    const { videoWidth: width, videoHeight: height } = video;
    const began = performance.now();
    // The engine wants times that grow.
    last = Math.max(last + 1, Math.round(began));
    const found = landmarker.detectForVideo(video, last);
    const hands = found.landmarks.map((_, i) => hand(found, i, width, height));
    const taken = round((data?.captureTime ?? now) / 1000, 4);
    send({ time: round(performance.now() / 1000, 4), taken, size: [width, height], seen: hands });
    took.push(performance.now() - began);
    draw(found);
    judge(hands.filter(known), began);
    if (took.length === SLOW_AFTER) {
      const middle = took.sort((a, b) => a - b)[SLOW_AFTER / 2];
      speed.textContent = `One picture takes ${middle.toFixed(0)} ms here.`;
      took.length = 0;
    }
  } catch (error) {
    trouble("engine", `What finds hands has stopped: ${error.message}`);
    return;
  }
  following();
}

/** Looks at the camera's next picture; where the browser cannot say when, 30 times a second. */
function following() {
  if ("requestVideoFrameCallback" in video) {
    // A picture that was awaited from a camera before would begin a second row of looks.
    video.cancelVideoFrameCallback(awaited);
    awaited = video.requestVideoFrameCallback(look);
  } else setTimeout(() => look(performance.now()), 33);
}

async function start() {
  if (!(await openCamera())) return;
  try {
    if (landmarker === null) await openEngine();
  } catch (error) {
    trouble("engine", `What finds hands does not start in this browser: ${error.message ?? error}`);
    return;
  }
  tell("Looking for a hand ...");
  following();
}

again.onclick = start;
// A page that is closed or left says so at once: the session need not wait for its silence.
addEventListener("pagehide", () => socket?.close());
document.addEventListener("visibilitychange", () => {
  if (document.hidden) send({ trouble: "hidden" });
});
connect().then(start, () => undefined);
