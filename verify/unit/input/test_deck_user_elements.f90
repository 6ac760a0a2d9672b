!> Unit test of deck_user_elements: order of unknowns, properties, rotation nodes, refused steps.
!! SPDX-License-Identifier: GPL-3.0-or-later
program test_deck_user_elements
  use amontons_deck, only: read_deck_text
  use amontons_errors, only: error_type, diagnostic_list_type
  use amontons_kinds, only: DP
  use amontons_model, only: model_type, job_options_type, DIALECT_ABAQUS
  use check, only: suite_type
  use samples, only: deck_lines
  implicit none
  character(*), parameter :: MODEL_PART = '*NODE;1,0,0,0;2,1,0,0;3,2,0,0;'
  character(*), parameter :: STEP_PART = '*STEP;*STATIC;*END STEP;'
  character(*), parameter :: ELEMENTS = '*ELEMENT, TYPE=U5, ELSET=E;11,1,2;12,2,3;'
  type(suite_type) :: suite
  type(model_type) :: model
  call check_order()
  call check_properties()
  call check_directions()
  call check_messages()
  call suite%finish()

contains

  !> One list; another from the second node on; a second list from the first node.
  subroutine check_order()
    call expect_read('*USER ELEMENT, TYPE=U5, NODES=2, VARIABLES=3;1,2;' // ELEMENTS, model)
    associate (kind => model%user_elements%kinds(1))
      call suite%that('node by node', all(kind%node == [1, 1, 2, 2]) .and. all(kind%dof == [1, 2, 1, 2]))
      call suite%that('as many coordinates as displacements', kind%n_coordinates == 2)
      call suite%that('number, SVARS', kind%number == 5 .and. kind%n_svars == 3)
    end associate
    call suite%that('memory: SVARS and energies', model%user_elements%n_memory == 2 * (3 + 8) .and. &
      model%user_elements%elements(2)%memory == 3 + 8)
    call expect_read('*USER ELEMENT, TYPE=U5, NODES=2;1,2;2,1;' // ELEMENTS, model)
    call suite%that('other ones from node 2', all(model%user_elements%kinds(1)%node == [1, 1, 2]) .and. &
      all(model%user_elements%kinds(1)%dof == [1, 2, 1]))
    call expect_read('*USER ELEMENT, TYPE=U5, NODES=2;1,2;1,3;' // ELEMENTS, model)
    call suite%that('a second list', all(model%user_elements%kinds(1)%node == [1, 1, 2, 2, 1, 2]) .and. &
      all(model%user_elements%kinds(1)%dof == [1, 2, 1, 2, 3, 3]))
  end subroutine check_order


  !> Reals, then integers; on one line or several.
  subroutine check_properties()
    call expect_read('*USER ELEMENT, TYPE=U5, NODES=2, PROPERTIES=2, I PROPERTIES=1;1;' // ELEMENTS // &
      '*UEL PROPERTY, ELSET=E;1.5,2.5;7;', model)
    associate (properties => model%user_elements%properties(model%user_elements%elements(2)%properties))
      call suite%near('reals', maxval(abs(properties%reals - [1.5_DP, 2.5_DP])), 0.0_DP, 0.0_DP)
      call suite%that('integers', all(properties%integers == [7]))
    end associate
    call expect_read('*USER ELEMENT, TYPE=U5, NODES=2;1;*ELEMENT, TYPE=SPRINGA, ELSET=S;13,1,3;*SPRING, ELSET=S;;1.;', model)
    call suite%that('a type without elements', .not. allocated(model%user_elements))
  end subroutine check_properties


  !> Rotation nodes; displacements that no element stiffens.
  subroutine check_directions()
    call expect_read('*USER ELEMENT, TYPE=U5, NODES=2;1;2,1,6;' // ELEMENTS, model)
    call suite%that('rotation nodes of 2 and 3', model%mesh%n_nodes == 5 .and. all(model%rotation_of(:3) == [0, 4, 5]))
    call suite%that('unknowns', all(model%user_elements%elements(1)%nodes == [1, 2, 4]) .and. &
      all(model%user_elements%elements(1)%place == [1, 4, 9]))
    call suite%that('no stiffness along y and z', all(model%mesh%is_unstiffened(2:, :3)) .and. &
      .not. any(model%mesh%is_unstiffened(1, :3)))
  end subroutine check_directions


  !> Errors with what is allowed.
  subroutine check_messages()
    character(*), parameter :: KIND = '*USER ELEMENT, TYPE=U5, NODES=2;1;'
    call expect_read(KIND // KIND // ELEMENTS, model)
    call suite%that('the same type twice', size(model%user_elements%kinds) == 1)
    call expect_message(KIND // ELEMENTS // '*USER ELEMENT, TYPE=U5, NODES=2;2;', 'is defined twice', step=STEP_PART)
    call expect_message(KIND // ELEMENTS // '*USER ELEMENT, TYPE=U6, NODES=2;', 'data lines are missing', step=STEP_PART)
    call expect_message(KIND // ELEMENTS // '*USER ELEMENT, TYPE=U6, NODES=0;1;', 'NODES must be 1 or more', step=STEP_PART)
    call expect_message(KIND // ELEMENTS // '*USER ELEMENT, TYPE=U6, NODES=2, COORDINATES=4;1;', 'COORDINATES must be 1, 2 or', &
      step=STEP_PART)
    call expect_message(KIND // ELEMENTS // '*UEL PROPERTY, ELSET=X;', 'no element set', step=STEP_PART)
    call expect_message(KIND // ELEMENTS // '*ELEMENT, TYPE=SPRINGA, ELSET=S;13,1,3;*SPRING, ELSET=S;;1.;*UEL PROPERTY, ELSET=S;', &
      'is no user element', step=STEP_PART)
    call expect_message(KIND // ELEMENTS, 'user elements', step='*STEP;*STATIC, RIKS;.1,1.;*CLOAD;3,1,1.;*END STEP;')
    call expect_message(KIND // ELEMENTS, 'user elements', step='*STEP;*STATIC, SOLVER=CONJUGATE GRADIENTS;*END STEP;')
  end subroutine check_messages


  include 'sample_deck.inc'

end program test_deck_user_elements
