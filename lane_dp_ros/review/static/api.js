// SPDX-FileCopyrightText: 2026 The lane_dp_ros authors
// SPDX-License-Identifier: Apache-2.0
// What the page asks its server.

async function request(path, options) {
  let response;
  try {
    response = await fetch(path, options);
  } catch {
    throw new Error("the server does not answer: was lane_dp review ended?");
  }
  const answer = await response.json();
  if (!response.ok) throw new Error(answer.error);
  return answer;
}

export const get = (path) => request(path);

export const post = (path, body = null) =>
  request(path, {
    method: "POST",
    headers: { "Content-Type": "application/json" },
    body: JSON.stringify(body),
  });

// Pictures by frame: those around the present frame, so that the next one is there before it is asked for.
const pictures = new Map();

/** Return the frame's picture as a loaded <img>. */
export async function picture(index) {
  const image = fetchPicture(index);
  try {
    await image.decode();
  } catch {
    pictures.delete(index); // asked for anew the next time
    const reason = await get(`/pictures/${index}`).catch((error) => error.message);
    throw new Error(`The picture of frame ${index + 1} cannot be shown: ${reason}`);
  }
  return image;
}

/** Begin to fetch the pictures of these frames, and forget all others. */
export function prefetch(indices) {
  indices.forEach(fetchPicture);
  for (const index of pictures.keys()) if (!indices.includes(index)) pictures.delete(index);
}

function fetchPicture(index) {
  if (!pictures.has(index)) {
    const image = new Image();
    image.src = `/pictures/${index}`;
    pictures.set(index, image);
  }
  return pictures.get(index);
}
