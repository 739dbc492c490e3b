    ${ module.core }$ core (
<%- for line in module.connections %>
        ${ line }$
<%- endfor %>
    );
