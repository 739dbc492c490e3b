<%- for line in header %>${ line }$
<% endfor %>
`default_nettype none

module ${ name }$<% if !parameters.is_empty() %> #(
<%- for line in parameters %>
    ${ line }$
<%- endfor %>
)<% endif %> (
<%- for line in ports %>
${ line }$
<%- endfor %>
);
<%- if !constants.is_empty() %>

    // Constants
<%- for line in constants %>
${ line }$
<%- endfor %>
<%- endif %>
<%- for stage in stages %>
<% for line in stage.title %>
${ line }$
<%- endfor %>
<%- for line in stage.words %>
${ line }$
<%- endfor %>
<%- let items = &stage.items %>
<%- include "items.v" %>
<%- for line in stage.registers %>
${ line }$
<%- endfor %>
<%- endfor %>
<%- if !unused.is_empty() %>

    // Unused bits, among them those that narrowing drops.
<%- for line in unused %>
${ line }$
<%- endfor %>
<%- endif %>
endmodule
<%- if let Some(name) = delay %>
<% include "delay.v" %>
<%- endif %>

`default_nettype wire
