/**
 * The element in a component, here of Preact without a build step; React 19 and others look the same. Put the framework's
 * module beside this file, as vendor/preact.js, or import it from your own bundle.
 *
 * Frameworks set attributes and properties and listen to events by themselves; methods are called on the element, which
 * a ref gives.
 */

import { Component, createRef, h, render } from './vendor/preact.js';
import '../reprise-player.js';

class Stage extends Component {
  player = createRef();
  state = { poses: [], said: 'loading' };

  describe = () => this.setState({ poses: this.player.current.info.sequences, said: 'click one' });

  go(name) {
    const { seconds } = this.player.current.goTo({ sequence: name, seconds: 0.5 });
    this.setState({ said: `there in ${seconds.toFixed(1)} s` });
  }

  render({ src }, { poses, said }) {
    const button = ({ name }) => h('li', { key: name }, h('button', { type: 'button', onClick: () => this.go(name) }, name));
    return [
      h('reprise-player', {
        ref: this.player,
        src,
        alt: 'A captured dancer',
        onload: this.describe,
        onarrive: () => this.setState({ said: 'arrived' }),
        onerror: ({ detail }) => this.setState({ said: detail.message }),
      }),
      h('ul', {}, poses.map(button)),
      h('output', {}, said),
    ];
  }
}

render(h(Stage, { src: '../demo.reprise' }), document.getElementById('app'));
