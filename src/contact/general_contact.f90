!> General contact: contact pairs of the exterior faces that are near each other and may touch.
!! SPDX-License-Identifier: GPL-3.0-or-later
!!
!! Two faces of different bodies are *near* if their normals oppose, the distance of their boxes is within the reach, and neither
!! lies behind the other by more than it can reach there (`reached_depth`). (Faces on the far sides of two sheets that touch oppose
!! each other too, one behind the other by both thicknesses.) The reach is the search radius of contact pairs and the way that the
!! bodies can move in the steps: a small one widens the comparison face by face; a large one adds the faces of whole patches.
!!
!! A pair has the near faces of one smooth patch as slave, so that the sides of a corner belong to different pairs, and all near
!! faces of another body as master. Around both come the faces of the patch that share a node with them, which complete the normals.
!! Pairs of one and the same two bodies have the same body as slave. Cost: linear in the faces that are near other bodies.
module amontons_general_contact
  use amontons_kinds, only: DP, I64
  use amontons_text, only: to_text, plural, NEWLINE
  use amontons_containers, only: integer_list_type, list_groups, ascending_order
  use amontons_elasticity, only: small_strain_modulus
  use amontons_surfaces, only: surface_type, contact_pair_type, general_contact_type
  use amontons_model, only: model_type, free_unknowns
  use amontons_body_motion, only: estimate_motion, are_rotations_prescribed, find_folding_bodies
  use amontons_contact_heights, only: assign_heights
  use amontons_exterior_membership, only: find_members, find_tie_lines, find_tied_faces, contact_rules, &
    find_uncounted_elements
  use amontons_exterior_surface, only: exterior_type, build_exterior, is_thin, has_area
  use amontons_body_thickness, only: measure_body_thickness
  use amontons_facets, only: facets_type
  use amontons_analytic_master, only: build_profile_facets, find_profile_projection, projection_type, PROJECTION_INSIDE
  use amontons_facet_search, only: facet_search_type, build_facet_search, find_near_facets
  use amontons_mortar_segmentation, only: MIN_FACING_COSINE
  use amontons_contact_pairs, only: SEARCH_RADIUS_RATIO
  use amontons_face_proximity, only: are_near, compare_faces, box_distance, find_active_faces, list_facets, exterior_positions
  use amontons_shared_slave_nodes, only: MIN_FREE_PART
  use amontons_rigid_exterior, only: rigid_bodies_type, collect_rigid_bodies, is_pair_driven, is_one_body, &
    unpaired_edges_warning, SHEETS_FACE, SHEETS_UNDECIDED
  implicit none
  private
  public :: general_pairs_type, find_general_pairs, near_faces_type, find_near_faces
  public :: face_data_type, side_type, build_model_exterior, collect_stiffness, add_to_side, compare_sides
  public :: body_name, is_rigid_sheet
  public :: TOUCHING_RADIUS, collect_face_data, find_interaction, are_named, make_surface

  real(DP), parameter :: TOUCHING_RADIUS = 0.05_DP         !< faces within this distance, over the edge, touch or soon will [-]
  real(DP), parameter :: TOL_HEIGHT = 1.0e-12_DP           !< of equal heights, over the edge: rounding [-]
  real(DP), parameter :: DISTINCT_STIFFNESS_RATIO = 1.5_DP !< bodies with a smaller ratio of their moduli are alike [-]
  real(DP), parameter :: DISTINCT_MESH_RATIO = 1.1_DP      !< the same for the mean edges [-]

  ! Why a body is the slave
  integer, parameter :: REASON_RIGID = 1, REASON_HELD = 2, REASON_SOFTER = 3, REASON_FINER = 4, REASON_SMALLER = 5, &
    REASON_FIRST = 6, REASON_ROLE = 7
  character(*), parameter :: REASON_WORDS(7) = [character(48) :: 'the master is rigid', &
    'supports hold the master', 'the slave is softer', 'the slave has the finer mesh', 'the slave is the smaller surface', &
    'both are alike', 'as *CONTACT FORMULATION says']

  !> The faces of a body near another one; modulus and edge are sums until they are divided by n.
  type :: side_type
    integer :: n = 0
    integer :: n_rigid = 0                         !< of them, of rigid bodies
    integer :: n_held = 0                          !< held along their normal
    real(DP) :: modulus = 0                        !< mean of Young's modulus [stress]
    real(DP) :: edge = 0                           !< mean of the longest edge [length]
    real(DP) :: area = 0                           !< sum [length^2]
  end type side_type

  !> What is known of the exterior faces beside their geometry.
  type :: face_data_type
    logical, allocatable :: is_rigid(:)            !< (n) all corners belong to a rigid body
    type(rigid_bodies_type) :: rigid               !< of the nodes
    logical, allocatable :: is_held(:)             !< (n) a support holds a corner along the normal in the first step
    real(DP), allocatable :: modulus(:)            !< (n) Young's modulus of the element [stress]
    integer, allocatable :: column_of(:)           !< (0:n_surfaces + n_ties) column of is_in of a surface of the rules, or of the
                                                   !! faces that a tie holds; else 0
    logical, allocatable :: is_in(:, :)            !< (n, columns) the face belongs to the surface
    integer, allocatable :: excluded(:, :)         !< (2, :) surfaces that do not touch: exclusions, given pairs, tied faces
    integer, allocatable :: given_pair(:)          !< of each of them: the given pair; 0: an exclusion or a tie
    integer, allocatable :: group(:)               !< (n) number of patch and surfaces: faces of a group follow the same rules
    integer :: n_groups = 0
    real(DP) :: motion = 0                         !< way of the bodies in the steps [length]
    logical :: can_turn = .false.                  !< steps prescribe rotations
    logical, allocatable :: folds(:)               !< (n_bodies) the body folds: its faces can turn
    integer, allocatable :: height_class(:)        !< (n) number of the height
    integer :: n_heights = 0                       !< different ones
    integer, allocatable :: member(:)              !< (n_groups) a face of the group
  end type face_data_type

  !> The pairs found, and their surfaces: number i becomes number size(model%surfaces) + i of the model.
  type :: general_pairs_type
    type(surface_type), allocatable :: surfaces(:)
    type(contact_pair_type), allocatable :: pairs(:)
    character(:), allocatable :: warning           !< rigid edges without a pair; '': none
    character(:), allocatable :: obstacle          !< bodies that can meet and get no pair; '': none
  end type general_pairs_type

  !> Near faces: face i is near a face of a group.
  type :: near_faces_type
    type(integer_list_type) :: face                !< faces
    type(integer_list_type) :: partner             !< groups; beyond n_groups: analytic surfaces, n_groups + their index
    logical :: has_all_couples = .false.           !< in: of each face every face that it is near, not one of each group
    type(integer_list_type) :: other               !< the near face of the partner group
    type(integer_list_type) :: driven              !< bodies near each other that supports drive, in twos; beyond n_bodies: surfaces
    type(integer_list_type) :: undecided           !< faces of rigid elements near each other, in twos: which sides meet is unknown
  end type near_faces_type

contains

  !> Finds the pairs. After: text says what was found and why; without *CONTACT it is '' and there are no pairs.
  subroutine find_general_pairs(model, found, text)
    type(model_type), intent(in) :: model
    type(general_pairs_type), intent(out) :: found
    character(:), allocatable, intent(out) :: text
    type(exterior_type) :: exterior
    type(face_data_type) :: data
    type(near_faces_type) :: near
    integer :: i
    text = ''
    allocate (found%pairs(0), found%surfaces(0))
    found%warning = ''
    found%obstacle = ''
    if (.not. allocated(model%general_contact)) return
    found%warning = unpaired_edges_warning(model)
    call build_model_exterior(model, 1, exterior)
    call collect_face_data(model, exterior, data)
    call find_near_faces(model%general_contact, exterior, data, SEARCH_RADIUS_RATIO, data%motion, near)
    call find_faces_near_profiles(model, exterior, data, data%motion, near)
    if (near%face%n > 0) call build_pairs(model, exterior, data, near, found, text)
    call report_sheets(model, exterior, near, found%obstacle)
    do i = 1, near%driven%n, 2
      call report_bodies(model, exterior, near%driven%items(i:i + 1), text)
    end do
    text = 'General contact: ' // plural(size(found%pairs), 'pair') // ' of ' // to_text(exterior%n_bodies) // &
      ' meshed bodies' // merge(':', '.', text /= '') // text
  end subroutine find_general_pairs


  !> The exterior of the model in a step, and of the whole bodies that others add. The faces of the first step have pairs.
  subroutine build_model_exterior(model, step, exterior)
    type(model_type), intent(in) :: model
    integer, intent(in) :: step                    !< from 1
    type(exterior_type), intent(out) :: exterior
    integer, allocatable :: node_pairs(:, :)
    allocate (node_pairs(2, 0))
    if (allocated(model%pretension_node_pairs)) node_pairs = model%pretension_node_pairs
    call build_exterior(model%mesh, find_uncounted_elements(model, step), node_pairs, exterior)
    if (exterior%n > 0) call measure_body_thickness(model%mesh, exterior, SEARCH_RADIUS_RATIO * maxval(exterior%edge_length), &
      exterior%thickness)
    call assign_heights(model, exterior)
  end subroutine build_model_exterior


  !> Stiffness, supports, surfaces and groups of the exterior faces.
  subroutine collect_face_data(model, exterior, data)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(out) :: data
    call collect_stiffness(model, exterior, data)
    call collect_memberships(model, exterior, data)
    call number_groups(exterior, data)
    data%can_turn = are_rotations_prescribed(model)
    if (allocated(model%general_contact)) data%motion = estimate_motion(model)
    data%folds = find_folding_bodies(model, exterior, data%is_rigid, data%motion)
  end subroutine collect_face_data


  !> Stiffness and supports of the exterior faces.
  subroutine collect_stiffness(model, exterior, data)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(out) :: data
    logical, allocatable :: is_free(:, :)
    integer :: f, i
    call collect_rigid_bodies(model, data%rigid)
    is_free = free_unknowns(model, 1)
    do i = 1, model%mesh%n_nodes
      if (data%rigid%reference(i) > 0) is_free(:, i) = is_free(:, i) .and. is_free(:, data%rigid%reference(i))
    end do
    allocate (data%is_rigid(exterior%n), data%is_held(exterior%n), data%modulus(exterior%n))
    do f = 1, exterior%n
      associate (corners => exterior%nodes(exterior%first(f):exterior%first(f) + exterior%n_corners(f) - 1))
        data%is_rigid(f) = all(data%rigid%reference(corners) > 0)
        data%is_held(f) = any([(norm2(merge(exterior%normal(:, f), 0.0_DP, is_free(:, corners(i)))) < MIN_FREE_PART, &
          i=1, size(corners))])
      end associate
      data%modulus(f) = 0.0_DP
      i = model%mesh%material(exterior%element(f))
      if (i > 0) data%modulus(f) = small_strain_modulus(model%materials(i))
    end do
  end subroutine collect_stiffness


  !> Whether contact can move one of two near faces; if supports drive the rigid bodies of both, near takes them in.
  subroutine judge_motion(exterior, data, f, m, near, can_move)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: f, m                    !< faces
    type(near_faces_type), intent(inout) :: near
    logical, intent(out) :: can_move
    can_move = .not. (data%is_rigid(f) .and. data%is_rigid(m))
    if (can_move) return
    associate (nodes => exterior%nodes(exterior%first([f, m])), bodies => exterior%body([f, m]))
      can_move = .not. is_pair_driven(data%rigid, nodes)
      if (.not. (can_move .or. is_one_body(data%rigid, nodes))) call add_bodies(near%driven, bodies)
    end associate
  end subroutine judge_motion


  !> Adds two bodies to a list, the smaller number first, unless they are its last ones.
  subroutine add_bodies(list, bodies)
    type(integer_list_type), intent(inout) :: list
    integer, intent(in) :: bodies(2)
    if (list%n > 0) then
      if (all(list%items(list%n - 1:list%n) == [minval(bodies), maxval(bodies)])) return
    end if
    call list%add(minval(bodies))
    call list%add(maxval(bodies))
  end subroutine add_bodies


  !> The faces of the surfaces that the rules, ties and given pairs name, and the pairs of surfaces left out.
  subroutine collect_memberships(model, exterior, data)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(inout) :: data
    type(general_contact_type) :: rules
    logical :: is_named(0:size(model%surfaces))
    integer, allocatable :: tie_line(:)
    integer :: i, n, n_ties
    rules = contact_rules(model)
    data%excluded = rules%excluded
    data%given_pair = spread(0, 1, size(rules%excluded, 2))
    do i = 1, size(model%pairs)
      if (.not. model%pairs(i)%is_general) call leave_out(model%pairs(i)%slave, model%pairs(i)%master, i)
    end do
    n_ties = 0
    if (allocated(model%ties)) n_ties = size(model%ties)
    do i = 1, n_ties                               ! the faces that it holds count as a surface after those of the model
      call leave_out(size(model%surfaces) + i, model%ties(i)%master, 0)
    end do
    is_named = .false.
    is_named([pack(data%excluded, data%excluded <= size(model%surfaces)), [rules%included, rules%assigned(:2, :), rules%roles, &
      rules%initialized(:2, :)]]) = .true.
    is_named(0) = .false.
    allocate (data%column_of(0:size(model%surfaces) + n_ties), source=0)
    allocate (data%is_in(exterior%n, count(is_named) + n_ties))
    n = 0
    do i = 1, size(model%surfaces)
      if (.not. is_named(i)) cycle
      n = n + 1
      data%column_of(i) = n
      data%is_in(:, n) = find_members(model, exterior, model%surfaces(i))
    end do
    if (n_ties > 0) tie_line = find_tie_lines(model)
    do i = 1, n_ties
      data%column_of(size(model%surfaces) + i) = n + i
      data%is_in(:, n + i) = find_tied_faces(model, exterior, model%ties(i), tie_line)
    end do

  contains

    !> Adds two surfaces to those that do not touch by the rules.
    subroutine leave_out(slave, master, pair)
      integer, intent(in) :: slave, master         !< indices of the surfaces
      integer, intent(in) :: pair                  !< given; 0: a tie
      data%excluded = reshape([data%excluded, slave, master], [2, size(data%excluded, 2) + 1])
      data%given_pair = [data%given_pair, pair]
    end subroutine leave_out

  end subroutine collect_memberships


  !> Numbers the groups: faces of one patch in the same surfaces with the same height.
  subroutine number_groups(exterior, data)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(inout) :: data
    integer, allocatable :: number(:)
    integer :: k, f, key
    call number_heights(exterior, data)
    data%group = (exterior%patch - 1) * data%n_heights + data%height_class
    data%n_groups = exterior%n_patches * data%n_heights
    do k = 0, size(data%is_in, 2)
      allocate (number(0:2 * data%n_groups + 1), source=0)
      data%n_groups = 0
      do f = 1, exterior%n
        key = 2 * data%group(f)
        if (k == 0) key = key + merge(1, 0, data%is_rigid(f))
        if (k > 0) key = key + merge(1, 0, data%is_in(f, max(k, 1)))
        if (number(key) == 0) then
          data%n_groups = data%n_groups + 1
          number(key) = data%n_groups
        end if
        data%group(f) = number(key)
      end do
      deallocate (number)
    end do
    allocate (data%member(data%n_groups))
    do f = 1, exterior%n
      data%member(data%group(f)) = f
    end do
  end subroutine number_groups


  !> Numbers the different heights of the faces. Cost: faces times heights, which are few.
  subroutine number_heights(exterior, data)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(inout) :: data
    real(DP) :: known(exterior%n)                  !< [length]
    integer :: f, k
    allocate (data%height_class(exterior%n))
    data%n_heights = 0
    do f = 1, exterior%n
      do k = 1, data%n_heights
        if (abs(known(k) - exterior%height(f)) <= TOL_HEIGHT * exterior%edge_length(f)) exit
      end do
      data%height_class(f) = k
      if (k > data%n_heights) known(k) = exterior%height(f)
      data%n_heights = max(data%n_heights, k)
    end do
  end subroutine number_heights


  !> The interaction of the faces of two groups; 0: they do not touch. A group 0 stands for an analytic surface.
  pure integer function find_interaction(rules, data, g, h, analytic) result(interaction)
    type(general_contact_type), intent(in) :: rules
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: g, h                    !< groups
    integer, intent(in) :: analytic                !< index of the analytic surface that group 0 stands for, else 0
    integer :: k
    interaction = 0
    if (.not. any([(are_named(data, g, h, rules%included(:, k), analytic), k=1, size(rules%included, 2))])) return
    if (any([(are_named(data, g, h, data%excluded(:, k), analytic), k=1, size(data%excluded, 2))])) return
    interaction = last_assigned(data, g, h, rules%assigned, analytic)
  end function find_interaction


  !> What the last line that names the faces of two groups assigns to them; 0: no line does.
  pure integer function last_assigned(data, g, h, assigned, analytic) result(found)
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: g, h                    !< groups
    integer, intent(in) :: assigned(:, :)          !< (3, :) two surfaces, and what is assigned
    integer, intent(in) :: analytic                !< index of the analytic surface that group 0 stands for, else 0
    integer :: k
    found = 0
    do k = 1, size(assigned, 2)
      if (are_named(data, g, h, assigned(:2, k), analytic)) found = assigned(3, k)
    end do
  end function last_assigned


  !> Whether two surfaces name the faces of both groups, in either order.
  pure logical function are_named(data, g, h, surfaces, analytic)
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: g, h                    !< groups
    integer, intent(in) :: surfaces(:)             !< (2) indices
    integer, intent(in) :: analytic                !< index of the analytic surface that group 0 stands for, else 0
    are_named = (is_of(data, g, surfaces(1), analytic) .and. is_of(data, h, surfaces(2), analytic)) .or. &
      (is_of(data, g, surfaces(2), analytic) .and. is_of(data, h, surfaces(1), analytic))
  end function are_named


  !> Whether the faces of a group belong to a surface.
  pure logical function is_of(data, group, surface, analytic)
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: group                   !< 0: the analytic surface
    integer, intent(in) :: surface                 !< index; 0: all
    integer, intent(in) :: analytic                !< index of the analytic surface
    is_of = surface == 0
    if (is_of) return
    if (group == 0) is_of = surface == analytic
    if (group > 0) is_of = data%is_in(data%member(group), data%column_of(surface))
  end function is_of


  !> Finds the near faces of all groups.
  subroutine find_near_faces(rules, exterior, data, radius, motion, near)
    type(general_contact_type), intent(in) :: rules
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    real(DP), intent(in) :: radius                 !< of the search without motion, over the edge [-]
    real(DP), intent(in) :: motion                 !< [length]
    type(near_faces_type), intent(inout) :: near
    type(facets_type) :: facets
    type(facet_search_type) :: search
    logical, allocatable :: is_active(:)
    integer, allocatable :: list(:), active(:), seen(:)
    real(DP) :: largest_edge, near_motion, height
    logical :: can_move
    integer :: i, j, k, n, f, g
    if (exterior%n == 0) return
    largest_edge = maxval(exterior%edge_length)
    near_motion = merge(motion, 0.0_DP, motion <= SEARCH_RADIUS_RATIO * largest_edge)
    height = 2 * max(0.0_DP, maxval(exterior%height))
    call find_active_faces(exterior, SEARCH_RADIUS_RATIO * largest_edge + motion + height, is_active)
    active = pack([(f, f=1, exterior%n)], is_active)
    if (size(active) == 0) return
    call list_facets(size(active), facets)
    call build_facet_search(facets, exterior_positions(exterior, active), (SEARCH_RADIUS_RATIO + 1) * largest_edge + near_motion &
      + height, search)
    allocate (seen(data%n_groups), source=0)
    do i = 1, size(active)
      f = active(i)
      call find_near_facets(search, exterior%centre(:, f), list, n)
      do k = 1, n
        j = active(list(k))
        g = data%group(j)
        if (exterior%body(j) == exterior%body(f)) cycle
        if (seen(g) == f .and. .not. (is_thin(exterior%depth(f), exterior%edge_length(f)) .or. near%has_all_couples)) cycle
        if (.not. are_near(exterior, f, j, radius, near_motion)) cycle
        if (find_interaction(rules, data, data%group(f), g, 0) == 0) cycle
        call judge_motion(exterior, data, f, j, near, can_move)
        if (can_move .and. compare_faces(exterior, f, j) == SHEETS_UNDECIDED) then
          call near%undecided%add(f)
          call near%undecided%add(j)
          cycle
        end if
        if (seen(g) == f .and. .not. near%has_all_couples) cycle
        seen(g) = f
        if (.not. can_move) cycle
        call near%face%add(f)
        call near%partner%add(g)
        call near%other%add(j)
      end do
    end do
    if (motion > near_motion .or. (any(data%folds) .and. .not. near%has_all_couples)) call add_reachable_faces(rules, exterior, &
      data, active, motion + radius * largest_edge + height, motion > near_motion, near)
  end subroutine find_near_faces


  !> The faces of groups that can meet somewhere on a long way: groups of different bodies with opposing normals, or any where steps
  !! prescribe rotations or a body folds, and of them the faces within the reach of the other group's box.
  subroutine add_reachable_faces(rules, exterior, data, active, reach, is_long, near)
    type(general_contact_type), intent(in) :: rules
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: active(:)               !< faces
    real(DP), intent(in) :: reach                  !< the way and the radius of the search [length]
    logical, intent(in) :: is_long                 !< of a short way only groups of bodies that fold are compared
    type(near_faces_type), intent(inout) :: near
    real(DP) :: box(3, 2, data%n_groups)
    integer, allocatable :: first(:), members(:)
    logical :: can_move, can_turn
    integer :: g, h, i
    box(:, 1, :) = huge(1.0_DP)
    box(:, 2, :) = -huge(1.0_DP)
    do i = 1, size(active)
      g = data%group(active(i))
      box(:, 1, g) = min(box(:, 1, g), exterior%box(:, 1, active(i)))
      box(:, 2, g) = max(box(:, 2, g), exterior%box(:, 2, active(i)))
    end do
    call list_groups(data%group(active), data%n_groups, first, members)
    do g = 1, data%n_groups
      do h = 1, data%n_groups
        if (first(g) == first(g + 1) .or. first(h) == first(h + 1)) cycle
        if (exterior%body(data%member(g)) == exterior%body(data%member(h))) cycle
        can_turn = any(data%folds(exterior%body(data%member([g, h]))))
        if (.not. (is_long .or. can_turn)) cycle
        if (box_distance(box(:, :, g), box(:, :, h)) > reach) cycle
        if (find_interaction(rules, data, g, h, 0) == 0) cycle
        call judge_motion(exterior, data, data%member(g), data%member(h), near, can_move)
        if (.not. can_move) cycle
        call add_opposing_faces(exterior, active(members(first(g):first(g + 1) - 1)), active(members(first(h):first(h + 1) - 1)), &
          box(:, :, h), h, reach, data%can_turn .or. can_turn, near)
      end do
    end do
  end subroutine add_reachable_faces


  !> Adds the faces of a group within the reach of another group's box that oppose one of its faces or can turn towards it; of two
  !! sheets those that face each other.
  subroutine add_opposing_faces(exterior, own, other, box, h, reach, can_turn, near)
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: own(:), other(:)        !< faces of the group and of the other group
    real(DP), intent(in) :: box(3, 2)              !< of the other group [length]
    integer, intent(in) :: h                       !< the other group
    real(DP), intent(in) :: reach                  !< [length]
    logical, intent(in) :: can_turn                !< steps prescribe rotations, or a body folds
    type(near_faces_type), intent(inout) :: near
    integer, parameter :: MAX_SAMPLED_FACES = 200
    integer :: i, k, stride
    stride = 1 + size(other) / MAX_SAMPLED_FACES
    do i = 1, size(own)
      if (box_distance(exterior%box(:, :, own(i)), box) > reach) cycle
      if (.not. any([(may_oppose(own(i), other(k)), k=1, size(other), stride)])) cycle
      call near%face%add(own(i))
      call near%partner%add(h)
    end do

  contains

    !> Whether two faces may oppose each other.
    pure logical function may_oppose(f, m)
      integer, intent(in) :: f, m                  !< faces
      may_oppose = can_turn .and. .not. all(is_thin(exterior%depth([f, m]), exterior%edge_length([f, m])))
      if (.not. may_oppose) may_oppose = dot_product(exterior%normal(:, f), exterior%normal(:, m)) <= 0.0_DP .and. &
        compare_faces(exterior, f, m) == SHEETS_FACE
    end function may_oppose

  end subroutine add_opposing_faces


  !> Adds the faces near analytic surfaces; partners are n_groups + the index of the surface. On a long way all faces count.
  subroutine find_faces_near_profiles(model, exterior, data, motion, near)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    real(DP), intent(in) :: motion                 !< [length]
    type(near_faces_type), intent(inout) :: near
    type(facets_type) :: facets
    type(projection_type) :: projection
    real(DP) :: reach
    integer :: s, f
    do s = 1, size(model%surfaces)
      if (.not. allocated(model%surfaces(s)%profile)) cycle
      do f = 1, exterior%n
        if (.not. has_area(exterior%n_corners(f), exterior%area(f), exterior%edge_length(f))) cycle
        if (find_interaction(model%general_contact, data, data%group(f), 0, s) == 0) cycle
        reach = SEARCH_RADIUS_RATIO * exterior%edge_length(f) + motion + max(0.0_DP, exterior%height(f))
        if (motion <= SEARCH_RADIUS_RATIO * exterior%edge_length(f)) then
          call build_profile_facets(model%surfaces(s)%profile, exterior%edge_length(f), facets)
          call find_profile_projection(facets, model%mesh%coordinates, exterior%centre(:, f), reach, projection)
          if (projection%status /= PROJECTION_INSIDE .or. projection%gap > reach .or. projection%gap < -exterior%thickness(f)) cycle
          if (dot_product(projection%normal, exterior%normal(:, f)) > -MIN_FACING_COSINE) cycle
        end if
        associate (nodes => [exterior%nodes(exterior%first(f)), model%surfaces(s)%nodes(1)])
          if (data%is_rigid(f) .and. is_pair_driven(data%rigid, nodes)) then
            if (.not. is_one_body(data%rigid, nodes)) call add_bodies(near%driven, [exterior%body(f), exterior%n_bodies + s])
            cycle
          end if
        end associate
        call near%face%add(f)
        call near%partner%add(data%n_groups + s)
      end do
    end do
  end subroutine find_faces_near_profiles


  !> Builds the pairs from the near faces: slave patch, other body and interaction make a pair.
  subroutine build_pairs(model, exterior, data, near, found, text)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(near_faces_type), intent(in) :: near
    type(general_pairs_type), intent(inout) :: found
    character(:), allocatable, intent(inout) :: text
    type(side_type), allocatable :: sides(:, :)
    integer, allocatable :: order(:), slaves(:), masters(:)
    integer(I64), allocatable :: key(:)
    logical, allocatable :: is_slave(:)
    integer :: i, k, n
    call measure_sides(exterior, data, near, sides)
    n = near%face%n
    allocate (key(n), is_slave(n))
    do i = 1, n
      call find_pair_key(model%general_contact, exterior, data, sides, near%face%items(i), near%partner%items(i), key(i), &
        is_slave(i))
    end do
    order = ascending_order(real(key, DP))
    i = 1
    do while (i <= n)
      k = i
      do while (k < n)
        if (key(order(k + 1)) /= key(order(i))) exit
        k = k + 1
      end do
      slaves = pack(near%face%items(order(i:k)), is_slave(order(i:k)))
      masters = pack(near%face%items(order(i:k)), .not. is_slave(order(i:k)))
      if (size(slaves) > 0) call append_pair(model, exterior, data, sides, slaves, masters, &
        near%partner%items(order(i)), found, text)
      i = k + 1
    end do
  end subroutine build_pairs


  !> What decides between slave and master, of the faces of each body that are near another one.
  subroutine measure_sides(exterior, data, near, sides)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(near_faces_type), intent(in) :: near
    type(side_type), allocatable, intent(out) :: sides(:, :)   !< (n_bodies, n_bodies) of a body towards another
    integer :: i
    allocate (sides(exterior%n_bodies, exterior%n_bodies))
    do i = 1, near%face%n
      if (near%partner%items(i) > data%n_groups) cycle
      associate (f => near%face%items(i), m => data%member(near%partner%items(i)))
        call add_to_side(exterior, data, f, sides(exterior%body(f), exterior%body(m)))
      end associate
    end do
    where (sides%n > 0)
      sides%modulus = sides%modulus / real(sides%n, DP)
      sides%edge = sides%edge / real(sides%n, DP)
    end where
  end subroutine measure_sides


  !> Adds a face to a side.
  pure subroutine add_to_side(exterior, data, f, side)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: f                       !< face
    type(side_type), intent(inout) :: side
    side%n = side%n + 1
    if (data%is_rigid(f)) side%n_rigid = side%n_rigid + 1
    if (data%is_held(f)) side%n_held = side%n_held + 1
    side%modulus = side%modulus + data%modulus(f)
    side%edge = side%edge + exterior%edge_length(f)
    side%area = side%area + exterior%area(f)
  end subroutine add_to_side


  !> Whether the first of two faces is the slave: the deck says so, or its side is the better slave.
  pure subroutine choose_slave(rules, exterior, data, sides, faces, is_slave, reason)
    type(general_contact_type), intent(in) :: rules
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(side_type), intent(in) :: sides(:, :)
    integer, intent(in) :: faces(2)
    logical, intent(out) :: is_slave
    integer, intent(out) :: reason                 !< REASON_...
    integer :: k
    do k = size(rules%roles, 2), 1, -1
      reason = REASON_ROLE
      associate (g => data%group(faces(1)), h => data%group(faces(2)), slave => rules%roles(1, k), master => rules%roles(2, k))
        is_slave = is_of(data, g, slave, 0) .and. is_of(data, h, master, 0)
        if (is_slave .or. (is_of(data, g, master, 0) .and. is_of(data, h, slave, 0))) return
      end associate
    end do
    associate (a => exterior%body(faces(1)), b => exterior%body(faces(2)))
      call compare_sides(sides(a, b), sides(b, a), is_slave, reason)
      if (reason == REASON_FIRST) is_slave = a < b
    end associate
  end subroutine choose_slave


  !> Whether a side is the better slave: its body is not rigid, not held along the normal by supports, softer, of finer mesh,
  !! smaller, or the first one, in this order.
  pure subroutine compare_sides(own, other, is_slave, reason)
    type(side_type), intent(in) :: own, other
    logical, intent(out) :: is_slave
    integer, intent(out) :: reason                 !< REASON_...
    if (own%n_rigid * other%n /= other%n_rigid * own%n) then
      reason = REASON_RIGID
      is_slave = own%n_rigid * other%n < other%n_rigid * own%n
    else if ((own%n_held > 0) .neqv. (other%n_held > 0)) then
      reason = REASON_HELD
      is_slave = own%n_held == 0
    else if (max(own%modulus, other%modulus) > DISTINCT_STIFFNESS_RATIO * min(own%modulus, other%modulus)) then
      reason = REASON_SOFTER
      is_slave = own%modulus < other%modulus
    else if (max(own%edge, other%edge) > DISTINCT_MESH_RATIO * min(own%edge, other%edge)) then
      reason = REASON_FINER
      is_slave = own%edge < other%edge
    else if (max(own%area, other%area) > DISTINCT_MESH_RATIO * min(own%area, other%area)) then
      reason = REASON_SMALLER
      is_slave = own%area < other%area
    else
      reason = REASON_FIRST
      is_slave = .true.
    end if
  end subroutine compare_sides


  !> The pair to which a near face belongs, as a number, and its side in it.
  subroutine find_pair_key(rules, exterior, data, sides, f, partner, key, is_slave)
    type(general_contact_type), intent(in) :: rules
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(side_type), intent(in) :: sides(:, :)
    integer, intent(in) :: f                       !< face
    integer, intent(in) :: partner                 !< group, or n_groups + analytic surface
    integer(I64), intent(out) :: key
    logical, intent(out) :: is_slave
    integer :: patch, other, interaction, initial, m, reason
    integer(I64) :: n_others, n_rules
    integer :: heights                             ! of both faces as one number, that of the slave first
    if (partner > data%n_groups) then
      is_slave = .true.
      patch = exterior%n_patches + exterior%body(f)   ! a profile needs no patches: it acts on nodes
      other = exterior%n_bodies + partner - data%n_groups
      interaction = find_interaction(rules, data, data%group(f), 0, partner - data%n_groups)
      initial = last_assigned(data, data%group(f), 0, rules%initialized, partner - data%n_groups)
      heights = data%height_class(f) - 1
    else
      m = data%member(partner)
      call choose_slave(rules, exterior, data, sides, [f, m], is_slave, reason)
      patch = exterior%patch(merge(f, m, is_slave))
      other = exterior%body(merge(m, f, is_slave))
      interaction = find_interaction(rules, data, data%group(f), partner, 0)
      initial = last_assigned(data, data%group(f), partner, rules%initialized, 0)
      heights = data%height_class(merge(f, m, is_slave)) - 1 + data%n_heights * (data%height_class(merge(m, f, is_slave)) - 1)
    end if
    n_others = int(exterior%n_bodies + size(data%column_of), I64)
    n_rules = int(size(rules%assigned, 2) + 1, I64)
    key = (int(patch, I64) * n_others + int(other, I64)) * n_rules + int(findloc(rules%assigned(3, :), interaction, dim=1), I64)
    key = (key * int(data%n_heights**2, I64) + int(heights, I64)) * int(size(rules%initialized, 2) + 1, I64) + int(initial, I64)
  end subroutine find_pair_key


  !> Appends one pair with its surfaces, and its line to the text.
  subroutine append_pair(model, exterior, data, sides, slaves, masters, partner, found, text)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    type(side_type), intent(in) :: sides(:, :)
    integer, intent(in) :: slaves(:), masters(:)   !< faces, perhaps several times; an analytic master has none
    integer, intent(in) :: partner                 !< n_groups + the index of an analytic master
    type(general_pairs_type), intent(inout) :: found
    character(:), allocatable, intent(inout) :: text
    type(contact_pair_type) :: pair
    type(surface_type) :: slave, master
    logical :: is_slave, has_profile
    integer :: reason, g, h, s
    has_profile = partner > data%n_groups
    if (size(masters) == 0 .and. .not. has_profile) return
    pair%slave_depth = minval(exterior%thickness(slaves))
    pair%slave_edge = maxval(exterior%edge_length(slaves))
    if (.not. has_profile) then                    ! two sheets: the sides that face each other at the start, to half an edge
      if (any(is_rigid_sheet(exterior, data, slaves)) .and. any(is_rigid_sheet(exterior, data, masters))) pair%slave_depth = &
        minval(exterior%edge_length(slaves))
    end if
    pair%is_general = .true.
    g = data%group(slaves(1))
    h = 0
    if (.not. has_profile) h = data%group(masters(1))
    call initialize_pair(model%general_contact, last_assigned(data, g, h, model%general_contact%initialized, &
      merge(partner - data%n_groups, 0, has_profile)), pair)
    pair%is_mortar = model%general_contact%is_mortar .and. .not. has_profile
    pair%height = exterior%height(slaves(1))
    if (.not. has_profile) pair%height = pair%height + exterior%height(masters(1))
    call make_surface(model, exterior, data, slaves, slave)
    slave%name = body_name(model, exterior, exterior%body(slaves(1)))
    if (.not. has_profile) slave%name = slave%name // '#' // to_text(exterior%patch(slaves(1)))
    found%surfaces = [found%surfaces, slave]
    pair%slave = size(model%surfaces) + size(found%surfaces)
    reason = REASON_RIGID
    if (has_profile) then
      s = partner - data%n_groups
      master = model%surfaces(s)
      pair%master = s
      pair%interaction = find_interaction(model%general_contact, data, g, 0, s)
    else
      pair%interaction = find_interaction(model%general_contact, data, g, h, 0)
      call make_surface(model, exterior, data, masters, master)
      master%name = body_name(model, exterior, exterior%body(masters(1)))
      found%surfaces = [found%surfaces, master]
      pair%master = size(model%surfaces) + size(found%surfaces)
      call choose_slave(model%general_contact, exterior, data, sides, [slaves(1), masters(1)], is_slave, reason)
    end if
    pair%name = slave%name // ' / ' // master%name
    call check_height(exterior, pair, slaves, found%obstacle)
    found%pairs = [found%pairs, pair]
    text = text // NEWLINE // '  slave ' // slave%name // ' (' // plural(size(slave%face), 'face') // '), master ' // master%name
    if (.not. has_profile) text = text // ' (' // plural(size(master%face), 'face') // ')'
    text = text // ', interaction ' // model%interactions(pair%interaction)%name // ': ' // trim(REASON_WORDS(reason)) // '.'
  end subroutine append_pair


  !> What becomes of the overclosures of a pair at the start.
  pure subroutine initialize_pair(rules, i, pair)
    type(general_contact_type), intent(in) :: rules
    integer, intent(in) :: i                       !< initialization; 0: they are pushed out in the first increment
    type(contact_pair_type), intent(inout) :: pair
    if (i == 0) return
    pair%is_shrink_fit = rules%initial(i)%is_fit
    pair%has_adjust = .not. pair%is_shrink_fit
    pair%adjust = rules%initial(i)%above
    pair%adjust_depth = rules%initial(i)%below
  end subroutine initialize_pair


  !> Whether the search of contact pairs reaches beyond their heights: an obstacle if not.
  subroutine check_height(exterior, pair, slaves, obstacle)
    type(exterior_type), intent(in) :: exterior
    type(contact_pair_type), intent(in) :: pair
    integer, intent(in) :: slaves(:)               !< faces
    character(:), allocatable, intent(inout) :: obstacle
    if (pair%height <= 0.5_DP * SEARCH_RADIUS_RATIO * minval(exterior%edge_length(slaves))) return
    if (obstacle /= '') obstacle = obstacle // NEWLINE
    obstacle = obstacle // 'General contact: *SURFACE PROPERTY ASSIGNMENT lifts the surfaces of ' // pair%name // ' by ' // &
      to_text(pair%height) // ' above their faces, more than ' // to_text(0.5_DP * SEARCH_RADIUS_RATIO) // ' of the edges of ' // &
      'their elements: contact is not searched that far. Take a smaller thickness or larger elements.'
  end subroutine check_height


  !> Whether a face is that of a rigid element, which has two sides and no depth.
  elemental logical function is_rigid_sheet(exterior, data, f)
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: f                       !< face
    is_rigid_sheet = data%is_rigid(f) .and. is_thin(exterior%depth(f), exterior%edge_length(f))
  end function is_rigid_sheet


  !> Says of bodies of rigid elements without a pair by hand that the sides that meet are unknown.
  subroutine report_sheets(model, exterior, near, obstacle)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(near_faces_type), intent(in) :: near
    character(:), allocatable, intent(inout) :: obstacle
    logical :: is_given(exterior%n_bodies, exterior%n_bodies)
    integer :: i, p, body(2)
    is_given = .false.
    do p = 1, size(model%pairs)
      body = [body_of(model%surfaces(model%pairs(p)%slave)), body_of(model%surfaces(model%pairs(p)%master))]
      if (all(body > 0)) is_given(body, body) = .true.
    end do
    do i = 1, near%undecided%n, 2
      body = exterior%body(near%undecided%items(i:i + 1))
      if (is_given(body(1), body(2))) cycle
      is_given(body, body) = .true.              ! once
      if (obstacle /= '') obstacle = obstacle // NEWLINE
      obstacle = obstacle // 'General contact (*CONTACT, line ' // to_text(model%general_contact%line) // '): ' // &
        body_name(model, exterior, minval(body)) // ' and ' // body_name(model, exterior, maxval(body)) // ' lie in one ' // &
        'surface or cross at the start. Both are of rigid elements, which have no depth: which of their sides meet is unknown. ' &
        // 'Name the sides (SPOS, SNEG) in a *CONTACT PAIR, move the bodies apart, or name both in *CONTACT EXCLUSIONS.'
    end do

  contains

    !> The body of the first face of a surface; 0: it has none.
    pure integer function body_of(surface)
      type(surface_type), intent(in) :: surface
      body_of = 0
      if (.not. allocated(surface%element)) return
      if (size(surface%element) > 0) body_of = exterior%body_of_element(surface%element(1))
    end function body_of

  end subroutine report_sheets


  !> Says once of two rigid bodies that supports drive that there is no pair of them.
  subroutine report_bodies(model, exterior, bodies, text)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: bodies(2)
    character(:), allocatable, intent(inout) :: text
    character(:), allocatable :: sentence
    sentence = NEWLINE // '  no pair of ' // body_name(model, exterior, minval(bodies)) // ' and ' // &
      body_name(model, exterior, maxval(bodies)) // ': supports prescribe the motion of both rigid bodies, and the job ends ' // &
      'if they meet.'
    if (index(text, sentence) == 0) text = text // sentence
  end subroutine report_bodies


  !> The surface of some faces and of those of their groups that share a node with them.
  subroutine make_surface(model, exterior, data, faces, surface)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    type(face_data_type), intent(in) :: data
    integer, intent(in) :: faces(:)                !< perhaps several times
    type(surface_type), intent(out) :: surface
    integer, allocatable :: list(:)
    logical :: is_in(exterior%n), has_node(model%mesh%n_nodes), is_group(data%n_groups)
    integer :: f, i
    is_in = .false.
    is_in(faces) = .true.
    is_group = .false.
    is_group(data%group(faces)) = .true.
    has_node = .false.
    do i = 1, size(faces)
      has_node(exterior%nodes(exterior%first(faces(i)):exterior%first(faces(i) + 1) - 1)) = .true.
    end do
    do f = 1, exterior%n
      if (.not. is_group(data%group(f)) .or. is_in(f)) cycle
      is_in(f) = any(has_node(exterior%nodes(exterior%first(f):exterior%first(f + 1) - 1)))
    end do
    list = pack([(f, f=1, exterior%n)], is_in)
    surface%element = exterior%element(list)
    surface%face = exterior%face(list)
    surface%thickness = exterior%thickness(list)
    has_node = .false.
    do i = 1, size(list)
      has_node(exterior%nodes(exterior%first(list(i)):exterior%first(list(i) + 1) - 1)) = .true.
    end do
    surface%nodes = pack([(i, i=1, model%mesh%n_nodes)], has_node)
  end subroutine make_surface


  !> The name of the first element set that is exactly the body, else 'BODY' and its number; the name of an analytic surface.
  function body_name(model, exterior, body) result(name)
    type(model_type), intent(in) :: model
    type(exterior_type), intent(in) :: exterior
    integer, intent(in) :: body                    !< body; beyond n_bodies: n_bodies + the index of an analytic surface
    character(:), allocatable :: name
    integer :: i, n
    if (body > exterior%n_bodies) then
      name = model%surfaces(body - exterior%n_bodies)%name
      return
    end if
    name = 'BODY' // to_text(body)
    if (.not. allocated(model%mesh%element_sets)) return
    n = count(exterior%body_of_element == body)
    do i = 1, size(model%mesh%element_sets)
      associate (set => model%mesh%element_sets(i))
        if (size(set%members) /= n) cycle
        if (any(exterior%body_of_element(set%members) /= body)) cycle
        name = set%name
        return
      end associate
    end do
  end function body_name

end module amontons_general_contact
