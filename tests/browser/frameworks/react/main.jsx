/** React 19: what it has is set as properties, and `on` with an event's own name, in small letters, listens to it. */

import { useEffect, useRef, useState } from 'react';
import { createRoot } from 'react-dom/client';
import 'reprise-player';

function App() {
  const [props, setProps] = useState(window.first);
  const player = useRef(null);
  useEffect(() => {
    window.set = (changes) => setProps((before) => ({ ...before, ...changes }));
    window.go = (frame) => player.current.goTo(frame);
  }, []);
  const { shown, src, alt, tint, controls, speed, theme, direction, count } = props;
  const told = ({ type }) => window.told.push(type);
  return (
    <main>
      <output>{count}</output>
      {shown && <reprise-player ref={player} src={src} alt={alt} tint={tint} controls={controls} speed={speed} theme={theme} direction={direction} onready={told} onload={told} onarrive={told} onerror={told} />}
    </main>
  );
}

createRoot(document.getElementById('app')).render(<App />);
